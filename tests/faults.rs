//! Faults of the machine: a disk that fills, a source that vanishes, a program that is killed, tiles that rot. The old city or the new
//! one, an error in one line, and the same command run again ends where an undisturbed one ends.
//! More of each: `FAULTS=200 cargo test --release --test faults`.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rilievo::city::City;
use support::random::Random;
use support::{PROGRAM, copied, import_arguments, sample, succeed, walk};

fn faults(usual: u32) -> u32 {
    let asked = std::env::var("FAULTS").ok();
    asked.and_then(|faults| faults.parse().ok()).unwrap_or(usual)
}

/// Names under a folder and what the files hold, in order.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let read = |path: PathBuf| {
        let name = path.strip_prefix(folder).unwrap().to_owned();
        (name, fs::read(path).unwrap())
    };
    walk(folder).into_iter().map(read).collect()
}

/// What a command did on a disk with too little room, and again when there was enough.
struct FullDisk {
    first_code: String,
    first_error: String,
    /// Exit status and messages.
    second: String,
    /// What the disk held after the first run and after the second.
    after: [PathBuf; 2],
}

/// Runs a command of which `{}` is the disk, on a disk that holds `before` and has `free_kib` left; none where this machine
/// lets nobody mount one.
fn on_full_disk(
    folder: &Path,
    before: Option<&Path>,
    free_kib: u64,
    arguments: &[String],
) -> Option<FullDisk> {
    const SCRIPT: &str = r#"
        disk="$1"; keep="$2"; free="$3"; before="$4"; shift 4
        mount -t tmpfs -o size=512m none "$disk" || exit 77
        [ -z "$before" ] || cp -a "$before/." "$disk" || exit 78
        used=$(df --output=used -k "$disk" | tail -1)
        mount -o remount,size=$((used + free))k "$disk" || exit 77
        "$@" 2>"$keep/first.err" >/dev/null; echo $? >"$keep/first.rc"
        cp -a "$disk" "$keep/first"
        mount -o remount,size=512m "$disk"
        "$@" 2>"$keep/second.err" >/dev/null; echo $? >"$keep/second.rc"
        cp -a "$disk" "$keep/second"
    "#;
    let keep = tempfile::tempdir_in(folder).unwrap().keep();
    let disk = keep.join("disk");
    fs::create_dir(&disk).unwrap();
    let status = Command::new("unshare")
        .args(["--user", "--map-root-user", "--mount", "sh", "-c", SCRIPT, "sh"])
        .args([&disk, &keep])
        .arg(free_kib.to_string())
        .arg(before.unwrap_or(Path::new("")))
        .arg(PROGRAM)
        .args(
            arguments
                .iter()
                .map(|argument| argument.replace("{}", &disk.display().to_string())),
        )
        .status();
    if !status.is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED: no file system can be mounted here, nothing was checked on a full disk");
        return None;
    }
    let text = |name: &str| fs::read_to_string(keep.join(name)).unwrap().trim().to_owned();
    Some(FullDisk {
        first_code: text("first.rc"),
        first_error: text("first.err"),
        second: format!("{} {}", text("second.rc"), text("second.err"))
            .trim()
            .to_owned(),
        after: [keep.join("first"), keep.join("second")],
    })
}

impl FullDisk {
    /// The first run failed in one line that names a file on the disk; true where it failed.
    fn failed_well(&self, what: &str) -> bool {
        let error = &self.first_error;
        let lines = error.lines().filter(|line| line.starts_with("rilievo: ")).count();
        if self.first_code == "0" {
            return false;
        }
        assert_eq!(self.first_code, "1", "{what}: {error}");
        assert_eq!(lines, 1, "{what}: {error}");
        assert!(
            error.contains("/disk") && error.to_lowercase().contains("space"),
            "{what}: {error}"
        );
        true
    }
}

#[test]
fn a_disk_that_fills_leaves_the_old_city_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let new = contents(&sample().join("city"));
    let size_kib: u64 = new.iter().map(|(_, bytes)| bytes.len() as u64 / 1024 + 4).sum();
    let import = import_arguments(&sample().join("files"), Path::new("{}/city"));
    // Another city in its place before: it stays, and is there in whole, until the new one is.
    let older = folder.path().join("older");
    fs::create_dir(&older).unwrap();
    let mut of_terrain = import_arguments(&sample().join("files"), &older.join("city"));
    let photo = of_terrain
        .iter()
        .position(|argument| argument == "--photo")
        .unwrap();
    of_terrain.drain(photo..photo + 5);
    succeed(&of_terrain);
    let old = contents(&older.join("city"));
    let runs = u64::from(faults(5));
    let mut failed = 0;
    for k in 0..runs {
        let free_kib = 4 + (size_kib * 11 / 10) * k / runs;
        let Some(run) = on_full_disk(folder.path(), Some(&older), free_kib, &import) else {
            return;
        };
        let what = format!("{free_kib} of {size_kib} KiB");
        if run.failed_well(&what) {
            failed += 1;
            assert!(
                contents(&run.after[0].join("city")) == old,
                "{what}: not the old city"
            );
        }
        assert!(run.second.starts_with('0'), "{what}: {}", run.second);
        assert!(
            contents(&run.after[1].join("city")) == new,
            "{what}: not the new city"
        );
        assert_eq!(
            fs::read_dir(&run.after[1]).unwrap().count(),
            1,
            "{what}: left over"
        );
    }
    assert!(failed >= runs / 2, "{failed} of {runs} disks were full");
}

/// An update, and what else is written: a film, a picture, a table, a sample.
#[test]
fn a_disk_that_fills_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let before = folder.path().join("before");
    fs::create_dir(&before).unwrap();
    let city = copied(&before);
    let old = contents(&city);
    let changed = folder.path().join("changed.gpkg");
    let edited = folder.path().join("edited");
    fs::create_dir(&edited).unwrap();
    let undisturbed = copied(&edited);
    fs::copy(city.join("buildings.gpkg"), &changed).unwrap();
    let some = ["--delete", "3,17,40"].map(str::to_owned);
    let update = |city: &str| -> Vec<String> {
        let mut all = vec!["update".to_owned(), city.to_owned()];
        all.extend(some.clone());
        all
    };
    succeed(&update(&undisturbed.display().to_string()));
    let new = contents(&undisturbed);
    let mut failed = 0;
    let sizes = [0, 4, 40, 300, 600, 100_000];
    for free_kib in sizes {
        let Some(run) = on_full_disk(folder.path(), Some(&before), free_kib, &update("{}/city")) else {
            return;
        };
        let what = format!("{free_kib} KiB");
        if run.failed_well(&what) {
            failed += 1;
            let left: Vec<_> = contents(&run.after[0].join("city"))
                .into_iter()
                .filter(|file| !file.0.starts_with("update.partial"))
                .collect();
            assert!(left == old, "{what}: not the old city");
            assert!(run.second.starts_with('0'), "{what}: {}", run.second);
        }
        assert!(
            contents(&run.after[1].join("city")) == new,
            "{what}: not the new city"
        );
    }
    assert!(failed > 2, "{failed} of {} disks were full", sizes.len());

    let city = sample().join("city").display().to_string();
    let flight = folder.path().join("flight.json");
    fs::write(
        &flight,
        r#"[{"t": 0, "eye": [288900, 4772600, 400], "look": [289180, 4773000, 215]}, {"t": 1, "eye": [289200, 4772950, 290], "look": [289400, 4773100, 215]}]"#,
    )
    .unwrap();
    let flight = flight.display().to_string();
    let view = ["--eye=288900,4772600,400", "--look=289180,4773000,215"];
    let commands: [(u64, Vec<&str>); 4] = [
        (
            24,
            vec![
                "film", &city, "--path", &flight, "--fps", "4", "--size", "96x54", "--out", "{}/film",
            ],
        ),
        (
            8,
            vec![
                "render", &city, view[0], view[1], "--size", "96x54", "--out", "{}/o.png",
            ],
        ),
        (
            16,
            vec!["lens", "bake", "tessar", "--f-number", "8", "--out", "{}/t.flare"],
        ),
        (60, vec!["sample", "{}/sample"]),
    ];
    for (free_kib, command) in commands {
        let command: Vec<String> = command.into_iter().map(str::to_owned).collect();
        let what = format!("{command:?}");
        let run = on_full_disk(folder.path(), None, free_kib, &command).unwrap();
        assert!(run.failed_well(&what), "{what}: there was room");
        assert!(run.second.starts_with('0'), "{what}: {}", run.second);
        let undisturbed = on_full_disk(folder.path(), None, 400_000, &command).unwrap();
        assert!(
            contents(&run.after[1]) == contents(&undisturbed.after[0]),
            "{what}: not the files of an undisturbed run"
        );
    }
}

/// Killed at any moment the folder holds the old city, or the new one, or none where there was none; run again it finishes.
#[test]
fn a_killed_import_leaves_the_old_city_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let city = folder.path().join("city");
    let imports = [true, false].map(|with_photos| {
        let mut import = import_arguments(&sample().join("files"), &city);
        let photo = import.iter().position(|argument| argument == "--photo").unwrap();
        if !with_photos {
            import.drain(photo..photo + 5);
        }
        import
    });
    let mut whole = Duration::ZERO;
    let cities = [0, 1].map(|k| {
        let begun = Instant::now();
        succeed(&imports[k]);
        whole = whole.max(begun.elapsed());
        contents(&city)
    });
    let (mut at, mut replaced) = (1, 0);
    let kills = faults(8);
    for k in 0..kills {
        let next = 1 - at;
        kill(
            &imports[next],
            whole.mul_f64(1.1 * f64::from(k + 1) / f64::from(kills)),
        );
        // Besides the mark of an import that was about to replace it.
        let mut now = contents(&city);
        now.retain(|(name, _)| !name.to_string_lossy().starts_with("import.cache_key"));
        if now == cities[next] {
            replaced += 1;
        } else {
            assert!(
                now == cities[at],
                "kill {k}: neither the old city nor the new one"
            );
            succeed(&imports[next]);
            assert!(
                contents(&city) == cities[next],
                "kill {k}: not what an undisturbed import makes"
            );
        }
        at = next;
    }
    println!("{kills} kills, {replaced} after the new city was there");
    assert!(replaced < kills, "no kill was in time");
    succeed(&imports[at]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// Killed at any moment a film's frames are whole ones of that film; run again it is finished.
#[test]
fn a_killed_film_holds_whole_frames() {
    let folder = tempfile::tempdir().unwrap();
    let flight = folder.path().join("flight.json");
    fs::write(
        &flight,
        r#"[{"t": 0, "eye": [288900, 4772600, 400], "look": [289180, 4773000, 215]}, {"t": 1, "eye": [289200, 4772950, 290], "look": [289400, 4773100, 215]}]"#,
    )
    .unwrap();
    let film = |out: &Path| -> Vec<String> {
        let city = sample().join("city");
        let mut all: Vec<String> = vec!["film".to_owned(), city.display().to_string()];
        all.extend(["--path".to_owned(), flight.display().to_string()]);
        all.extend(["--fps", "8", "--size", "64x36", "--samples", "1", "--out"].map(str::to_owned));
        all.push(out.display().to_string());
        all
    };
    let whole = folder.path().join("whole");
    let begun = Instant::now();
    succeed(&film(&whole));
    let took = begun.elapsed();
    let frames = contents(&whole);
    let out = folder.path().join("film");
    let kills = faults(4);
    for k in 0..kills {
        kill(
            &film(&out),
            took.mul_f64(1.1 * f64::from(k + 1) / f64::from(kills)),
        );
        if out.is_dir() {
            let ours = contents(&out).into_iter();
            let mut pictures =
                ours.filter(|(name, _)| name.extension().is_some_and(|ending| ending == "png"));
            assert!(
                pictures.all(|frame| frames.contains(&frame)),
                "kill {k}: a frame is not whole"
            );
        }
        succeed(&film(&out));
        assert!(contents(&out) == frames, "kill {k}: not the film");
        fs::remove_dir_all(&out).unwrap();
    }
}

/// Starts the program and kills it after a while.
fn kill(arguments: &[String], after: Duration) {
    let mut program = Command::new(PROGRAM)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(after);
    program.kill().unwrap();
    program.wait().unwrap();
}

/// A source that is removed or cut while it is read: the city of its whole file, or an error; then nothing is put in place.
#[test]
fn a_source_that_vanishes_makes_no_city() {
    let folder = tempfile::tempdir().unwrap();
    let whole = contents(&sample().join("city"));
    let rounds = faults(6);
    let mut refused = 0;
    for k in 0..rounds {
        let files = folder.path().join("files");
        let _ = fs::remove_dir_all(&files);
        fs::create_dir(&files).unwrap();
        for path in walk(&sample().join("files")) {
            fs::copy(&path, files.join(path.file_name().unwrap())).unwrap();
        }
        let city = folder.path().join("city");
        let program = Command::new(PROGRAM)
            .args(import_arguments(&files, &city))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(u64::from(40 + 900 * (k / 3) / rounds)));
        for name in ["terrain.tif", "buildings.gpkg", "photo_1_1.tif"] {
            match k % 3 {
                0 => fs::remove_file(files.join(name)).unwrap(),
                1 => {
                    let file = fs::File::options().write(true).open(files.join(name)).unwrap();
                    file.set_len(file.metadata().unwrap().len() / 2).unwrap();
                }
                _ => fs::write(files.join(name), b"something else").unwrap(),
            }
        }
        let output = program.wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0) => assert!(contents(&city) == whole, "round {k}: another city"),
            Some(1) => {
                refused += 1;
                assert!(!city.exists(), "round {k}: {errors}");
                assert!(errors.contains("files/"), "round {k}: {errors}");
            }
            code => panic!("round {k}: {code:?}: {errors}"),
        }
        let _ = fs::remove_dir_all(&city);
    }
    println!("{refused} of {rounds} refused");
}

/// Tiles with some bytes changed, drawn by the program: a picture or an error, in bounded time and memory.
#[test]
fn rotten_tiles_are_drawn_or_said() {
    const MOST_S: u64 = 60;
    const MOST_MIB: u64 = 1024;
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let tiles: Vec<PathBuf> = walk(&city)
        .into_iter()
        .filter(|path| path.extension().is_some_and(|ending| ending == "tif"))
        .collect();
    let whole: Vec<Vec<u8>> = tiles.iter().map(|path| fs::read(path).unwrap()).collect();
    let mut random = Random(5);
    let (mut drawn, mut said, mut most_mib) = (0, 0, 0);
    for seed in 0..faults(8) {
        let some: Vec<usize> = (0..1 + random.below(3))
            .map(|_| random.below(tiles.len()))
            .collect();
        for &tile in &some {
            fs::write(&tiles[tile], random.changed(&whole[tile])).unwrap();
        }
        let mut program = Command::new(PROGRAM)
            .args(["render", city.to_str().unwrap(), "--eye=288900,4772500,1000"])
            .args(["--look=289230,4773050,215", "--size=64x48", "--out"])
            .arg(folder.path().join("o.png"))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = program.try_wait().unwrap() {
                break status;
            }
            most_mib = most_mib.max(peak_mib(program.id()));
            if begun.elapsed() > Duration::from_secs(MOST_S) {
                program.kill().unwrap();
                panic!("seed {seed}: still running after {MOST_S} s");
            }
            std::thread::sleep(Duration::from_millis(10));
        };
        let mut errors = String::new();
        std::io::Read::read_to_string(&mut program.stderr.take().unwrap(), &mut errors).unwrap();
        match status.code() {
            Some(0) => drawn += 1,
            Some(1) => {
                assert!(errors.contains(".tif"), "seed {seed}: {errors}");
                said += 1;
            }
            code => panic!("seed {seed}: {code:?}: {errors}"),
        }
        for &tile in &some {
            fs::write(&tiles[tile], &whole[tile]).unwrap();
        }
        assert!(City::open(&city).is_ok());
    }
    println!("{drawn} drawn, {said} refused, at most {most_mib} MiB");
    assert!(most_mib < MOST_MIB, "{most_mib} MiB");
}

/// Peak resident memory of a process, MiB.
fn peak_mib(process: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    line.and_then(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok())
        .unwrap_or(0)
        / 1024
}
