//! The `rilievo` program: parse, run, print the error.

fn main() -> std::process::ExitCode {
    // Mesa complains on standard error when this is unset, as it is for root and in services.
    #[cfg(target_os = "linux")]
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: no other thread runs yet.
        unsafe { std::env::set_var("XDG_RUNTIME_DIR", std::env::temp_dir()) };
    }
    // PROJ loads missing grids from the net only for a user who asks for it by this variable.
    if std::env::var_os("PROJ_NETWORK").is_none() {
        // SAFETY: no other thread runs yet.
        unsafe { std::env::set_var("PROJ_NETWORK", "OFF") };
    }
    // GDAL asks servers only for a user who names an address: a file from a stranger may name some, too.
    let names_address = |argument: std::ffi::OsString| {
        let argument = argument.to_string_lossy();
        argument.contains("://") || argument.starts_with("/vsi")
    };
    if !std::env::args_os().any(names_address) {
        for (name, value) in rilievo::source::OFFLINE {
            if std::env::var_os(name).is_none() {
                // SAFETY: no other thread runs yet.
                unsafe { std::env::set_var(name, value) };
            }
        }
    }
    rilievo::cli::main()
}
