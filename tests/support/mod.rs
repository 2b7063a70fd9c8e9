//! What several test files need: the sample city, the program, and an independent ray caster.
#![allow(dead_code)]

pub mod random;
pub mod raycaster;
pub mod records;
pub mod survey;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use glam::DVec3;
use rilievo::camera::Camera;
use rilievo::output::{FrameRequest, Renderer};
use rilievo::relief::ReliefSettings;
use rilievo::space::{Pose, Sun};

/// The program under test.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_rilievo");

/// Runs the program.
pub fn rilievo<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Output {
    Command::new(PROGRAM)
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Runs the program and requires success.
pub fn succeed<S: AsRef<std::ffi::OsStr> + std::fmt::Debug>(arguments: &[S]) -> String {
    let output = rilievo(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs the program and requires that it refuses in one line; gives the line.
pub fn refused<S: AsRef<std::ffi::OsStr> + std::fmt::Debug>(arguments: &[S]) -> String {
    let output = rilievo(arguments);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {errors}");
    let lines: Vec<&str> = errors
        .lines()
        .filter(|line| line.starts_with("rilievo: "))
        .collect();
    assert_eq!(lines.len(), 1, "{arguments:?}: {errors}");
    lines[0].to_owned()
}

/// Folder with the sample's source files (`files/`) and its city (`city/`), made once for each build of the program.
pub fn sample() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let program = std::fs::metadata(PROGRAM).expect("the program exists");
        let age = program
            .modified()
            .expect("a time")
            .duration_since(std::time::UNIX_EPOCH)
            .expect("after 1970");
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!(
            "sample-{}-{}",
            age.as_millis(),
            program.len()
        ));
        if !folder.join("city/city.toml").is_file() {
            let _ = std::fs::remove_dir_all(&folder);
            let files = folder.join("files");
            succeed(&[Path::new("sample"), &files]);
            succeed(&import_arguments(&files, &folder.join("city")));
        }
        folder
    })
}

/// A copy of the sample city that may be changed.
pub fn copied(folder: &Path) -> PathBuf {
    let (from, city) = (sample().join("city"), folder.join("city"));
    for entry in walk(&from) {
        let to = city.join(entry.strip_prefix(&from).unwrap());
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(&entry, to).unwrap();
    }
    // Written last, as by an import.
    let manifest = std::fs::read(from.join("city.toml")).unwrap();
    std::fs::write(city.join("city.toml"), manifest).unwrap();
    city
}

/// Every file under a folder.
pub fn walk(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(walk(&path)),
            false => found.push(path),
        }
    }
    found.sort();
    found
}

/// The arguments that import the sample's files.
pub fn import_arguments(files: &Path, out: &Path) -> Vec<String> {
    let file = |name: &str| files.join(name).display().to_string();
    let mut arguments: Vec<String> = ["import", "--terrain"].map(String::from).to_vec();
    arguments.push(file("terrain.tif"));
    arguments.extend(["--buildings".to_owned(), file("buildings.gpkg")]);
    arguments.extend([
        "--height-field".to_owned(),
        "height_m".to_owned(),
        "--photo".to_owned(),
    ]);
    arguments.extend(["photo_0_0.tif", "photo_1_0.tif", "photo_0_1.tif", "photo_1_1.tif"].map(file));
    arguments.extend(["--out".to_owned(), out.display().to_string()]);
    arguments
}

/// A pinhole camera; `fov_y` in radians.
pub fn pinhole(eye: [f64; 3], target: [f64; 3], fov_y: f64) -> Camera {
    let pose = Pose::looking_at(DVec3::from_array(eye), DVec3::from_array(target));
    Camera::pinhole(pose, fov_y)
}

/// A frame of buildings out of the building map, without a lens.
pub fn request<'a>(camera: &'a Camera, sun: &'a Sun, size: [u32; 2]) -> FrameRequest<'a> {
    FrameRequest {
        camera,
        sun,
        size,
        relief: ReliefSettings::default(),
        flare: None,
        exposure: 1.0,
    }
}

/// Linear radiance of a still of so many samples.
pub fn radiance(renderer: &mut Renderer, request: &FrameRequest<'_>, samples: u32) -> Vec<[f32; 3]> {
    let requests = vec![*request; samples as usize];
    renderer.still_of(&requests, true).expect("a still").radiance
}

/// Three views of the sample city: street level, oblique, high. Eye and look in its CRS.
pub const VIEWS: [(&str, [f64; 3], [f64; 3]); 3] = [
    (
        "street",
        [289_442.35, 4_773_173.31, 229.71],
        [289_407.71, 4_773_153.31, 228.5],
    ),
    (
        "oblique",
        [288_900.0, 4_772_600.0, 400.0],
        [289_180.0, 4_773_000.0, 215.0],
    ),
    (
        "high",
        [288_900.0, 4_772_500.0, 1000.0],
        [289_230.0, 4_773_050.0, 215.0],
    ),
];

/// The data beside the project, where there is any; says so loudly where there is none.
pub fn shared_data() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!(
        "SKIPPED: {} is absent, nothing was checked on real data",
        folder.display()
    );
    None
}

/// A pinhole, by its definition.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub eye: DVec3,
    pub target: DVec3,
    pub fov_y: f64,
}

impl View {
    pub fn camera(&self) -> Camera {
        pinhole(self.eye.to_array(), self.target.to_array(), self.fov_y)
    }
}

/// The ray through a pixel's centre of a pinhole image, derived here from the definition of the camera alone.
pub fn ray(view: &View, size: [u32; 2], column: u32, row: u32) -> DVec3 {
    let forward = (view.target - view.eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let half = (view.fov_y / 2.0).tan();
    let [width, height] = size.map(f64::from);
    let x = (f64::from(column) + 0.5) / width * 2.0 - 1.0;
    let y = 1.0 - (f64::from(row) + 0.5) / height * 2.0;
    (forward + right * (x * half * width / height) + up * (y * half)).normalize()
}
