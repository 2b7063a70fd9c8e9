//! The `rilievo` program: parse, run, print the error.

fn main() -> std::process::ExitCode {
    rilievo::cli::main()
}
