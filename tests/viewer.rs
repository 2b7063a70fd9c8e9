//! The window, driven by real mouse and key events under a virtual display: what is under the cursor stays there, time and keys act,
//! closing it ends the program with status 0. Needs Xvfb and xdotool (tools/set-up installs them); skips loudly without.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use glam::{DVec2, DVec3};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::relief::pick;
use rilievo::scene::{TerrainMesh, TileSet};
use rilievo::source::{SurveyKind, identify};
use rilievo::space::{Pose, Projection};
use rilievo::viewer::{Cursor, Navigator};
use serde_json::Value;
use support::records::{is_a_fresh_import, records};

const SIZE: [u32; 2] = [640, 360];

/// A virtual display.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// None, said loudly, where there can be no display.
    fn open() -> Option<Self> {
        let has = |program: &str| Command::new(program).arg("-version").output().is_ok();
        if !has("Xvfb") || !has("xdotool") {
            eprintln!("SKIPPED: Xvfb or xdotool is absent, the window was not driven; run tools/set-up");
            return None;
        }
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "800x600x24",
                "-nolisten",
                "tcp",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap())
            .read_line(&mut number)
            .unwrap();
        Some(Self {
            server,
            name: format!(":{}", number.trim()),
        })
    }

    /// Sends real events.
    fn xdotool(&self, arguments: &[&str]) -> String {
        let output = Command::new("xdotool")
            .args(arguments)
            .env("DISPLAY", &self.name)
            .output()
            .unwrap();
        String::from_utf8_lossy(&output.stdout).trim().to_owned()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The program with a window on the sample city.
struct Viewer<'a> {
    display: &'a Display,
    program: Child,
    journal: PathBuf,
    window: String,
}

impl<'a> Viewer<'a> {
    fn open(display: &'a Display, city: &Path, folder: &Path) -> Self {
        let journal = folder.join("journal.jsonl");
        let program = Command::new(support::PROGRAM)
            .arg("fly")
            .arg(city)
            .args(["--size", "640x360", "--time", "2026-06-21T14:00:00+02:00"])
            .args(["--eye", "288900,4772600,400", "--look", "289180,4773000,215"])
            .arg("--images")
            .arg(folder)
            .arg("--journal")
            .arg(&journal)
            .env("DISPLAY", &display.name)
            .env("XDG_STATE_HOME", folder)
            .env_remove("WAYLAND_DISPLAY")
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut viewer = Self {
            display,
            program,
            journal,
            window: String::new(),
        };
        viewer.wait_for("a first frame", |frames| !frames.is_empty());
        viewer.window = display.xdotool(&["search", "--name", "Rilievo"]);
        assert!(!viewer.window.is_empty(), "the window has the program's name");
        // Without a window manager nobody gives it the keyboard.
        display.xdotool(&["windowfocus", "--sync", &viewer.window]);
        viewer
    }

    fn frames(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(&self.journal).unwrap_or_default();
        text.lines()
            .filter_map(|line| serde_json::from_str(line).ok())
            .collect()
    }

    /// Waits until the journal says so; for long, because the machine may be busy.
    fn wait_for(&mut self, what: &str, is_so: impl Fn(&[Value]) -> bool) {
        let start = Instant::now();
        while !is_so(&self.frames()) {
            assert!(
                start.elapsed() < Duration::from_secs(60),
                "no {what}: {:?}",
                self.frames().last()
            );
            assert!(
                self.program.try_wait().unwrap().is_none(),
                "the program ended before {what}"
            );
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Waits for a full and sharpening frame of which `changed` holds, and gives its projection.
    fn at_rest(&mut self, changed: impl Fn(&Value) -> bool) -> Projection {
        let is_full =
            |frame: &Value| frame["frame"] == frame["window"] && frame["samples"].as_u64() >= Some(2);
        self.wait_for("rest after a change", |frames| {
            frames
                .last()
                .is_some_and(|frame| is_full(frame) && changed(frame))
        });
        projection(self.frames().last().unwrap())
    }

    /// The same, when the camera is no longer where it was.
    fn moved_from(&mut self, before: &Projection) -> Projection {
        let pose = before.pose;
        self.at_rest(|frame| projection(frame).pose != pose)
    }

    fn move_to(&self, position: DVec2) {
        let [x, y] = position.to_array().map(|value| format!("{value}"));
        self.display
            .xdotool(&["mousemove", "--window", &self.window, &x, &y]);
    }

    fn drag(&self, button: &str, from: DVec2, to: DVec2) {
        self.move_to(from);
        self.display.xdotool(&["mousedown", button]);
        for step in 1..=8 {
            self.move_to((from + (to - from) * f64::from(step) / 8.0).round());
            std::thread::sleep(Duration::from_millis(60));
        }
        // The last of the moves is seen before the button is let go.
        std::thread::sleep(Duration::from_millis(400));
        self.display.xdotool(&["mouseup", button]);
    }

    fn click(&self, position: DVec2) {
        self.move_to(position);
        std::thread::sleep(Duration::from_millis(120));
        self.display.xdotool(&["click", "1"]);
        // Not so soon that two would be a double click.
        std::thread::sleep(Duration::from_millis(500));
    }

    /// Closes the window by its key; the status that the program ends with.
    fn close(mut self) -> Option<i32> {
        self.display.xdotool(&["key", "Escape"]);
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(30) {
            if let Some(status) = self.program.try_wait().unwrap() {
                return status.code();
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        None
    }
}

impl Drop for Viewer<'_> {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn vector(value: &Value) -> DVec3 {
    let numbers: Vec<f64> = value
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    DVec3::from_slice(&numbers)
}

fn projection(frame: &Value) -> Projection {
    let pose = Pose::looking_along(vector(&frame["eye"]), vector(&frame["forward"]));
    Projection::new(pose, SIZE, frame["fov_y"].as_f64().unwrap())
}

/// Where a point lies in an image, pixels from its top left corner.
fn pixel(projection: &Projection, point: DVec3) -> DVec2 {
    let relative = point - projection.pose.eye;
    let ahead = relative.dot(projection.pose.forward);
    let ndc = DVec2::new(
        relative.dot(projection.pose.right) / ahead,
        relative.dot(projection.pose.up) / ahead,
    ) / projection.tan_half_fov();
    (ndc * DVec2::new(0.5, -0.5) + 0.5) * DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]))
}

fn point_under(tiles: &TileSet, projection: &Projection, position: DVec2) -> DVec3 {
    Navigator::point_under(tiles, Cursor { projection, position }).unwrap()
}

/// Two fingers that turn anticlockwise by an angle: the city turns so in the image, round what is under the cursor.
#[test]
fn two_fingers_turn_the_city_round_what_is_under_them() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    renderer.load_finest().unwrap();
    let tiles = &renderer.resident.tiles;
    // From straight above, nearly, where an angle in the image is one on the ground.
    let (eye, target) = (
        DVec3::new(289_180.0, 4_772_960.0, 900.0),
        DVec3::new(289_180.0, 4_773_000.0, 215.0),
    );
    let mut navigator = Navigator::new(tiles, Pose::looking_at(eye, target));
    let seen = |navigator: &Navigator| Projection::new(navigator.pose, SIZE, 0.8);
    let before = seen(&navigator);
    let position = DVec2::new(300.0, 200.0);
    let held = point_under(tiles, &before, position);
    let beside = held + 100.0 * before.pose.right;
    let cursor = Cursor {
        projection: &before,
        position,
    };
    assert!(navigator.rotate(tiles, cursor, 0.5));
    let after = seen(&navigator);
    assert!(
        pixel(&after, held).distance(position) < 0.5,
        "it turned round something else"
    );
    let towards = pixel(&after, beside) - position;
    let angle = (-towards.y).atan2(towards.x);
    assert!((angle - 0.5).abs() < 0.02, "it turned by {angle}");
}

#[test]
fn the_window_does_what_the_mouse_and_the_keys_say() {
    let Some(display) = Display::open() else { return };
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    renderer.load_finest().unwrap();
    let tiles = &renderer.resident.tiles;
    let folder = tempfile::tempdir().unwrap();
    let mut viewer = Viewer::open(&display, &support::sample().join("city"), folder.path());

    // A drag with the left button: what was under the cursor still is.
    let before = viewer.at_rest(|_| true);
    let [from, to] = [DVec2::new(400.0, 230.0), DVec2::new(330.0, 280.0)];
    let held = point_under(tiles, &before, from);
    viewer.drag("1", from, to);
    let after = viewer.moved_from(&before);
    assert!(after.pose.eye.distance(before.pose.eye) > 10.0, "nothing moved");
    assert_eq!(after.pose.forward, before.pose.forward, "a pan does not turn");
    let off = pixel(&after, held).distance(to);
    assert!(off <= 2.0, "panned {off} pixels off");

    // The wheel: nearer to what is under the cursor, which stays under it.
    let at = DVec2::new(420.0, 250.0);
    let aimed = point_under(tiles, &after, at);
    viewer.move_to(at);
    for _ in 0..4 {
        display.xdotool(&["click", "4"]);
    }
    let zoomed = viewer.moved_from(&after);
    let fraction = zoomed.pose.eye.distance(aimed) / after.pose.eye.distance(aimed);
    // A step leaves 0.85 of the way. A synthetic click is told twice, as it is pressed and let go; a wheel's own motion once.
    let is_step = |steps: i32| (fraction / 0.85_f64.powi(steps) - 1.0).abs() < 0.01;
    assert!(is_step(4) || is_step(8), "{fraction} of the distance is left");
    let off = pixel(&zoomed, aimed).distance(at);
    assert!(off <= 2.0, "zoomed {off} pixels off");

    // A drag with the right button turns round what is under the cursor, at the same distance.
    let at = DVec2::new(350.0, 220.0);
    let pivot = point_under(tiles, &zoomed, at);
    viewer.drag("3", at, at + DVec2::new(80.0, 10.0));
    let orbited = viewer.moved_from(&zoomed);
    assert!(
        orbited.pose.forward.dot(zoomed.pose.forward) < 0.99,
        "nothing turned"
    );
    let distances = [zoomed, orbited].map(|view| view.pose.eye.distance(pivot));
    assert!((distances[0] / distances[1] - 1.0).abs() < 1e-3, "{distances:?}");
    let off = pixel(&orbited, pivot).distance(at);
    assert!(off <= 2.0, "the pivot moved by {off} pixels");

    // Keys: ahead, and down into the ground, where the eye stops.
    display.xdotool(&["keydown", "w"]);
    std::thread::sleep(Duration::from_millis(500));
    display.xdotool(&["keyup", "w"]);
    let flown = viewer.moved_from(&orbited);
    let way = flown.pose.eye - orbited.pose.eye;
    assert!(way.dot(orbited.pose.forward) > 2.0, "W leads ahead: {way}");
    display.xdotool(&["keydown", "shift", "keydown", "q"]);
    std::thread::sleep(Duration::from_millis(3000));
    display.xdotool(&["keyup", "q", "keyup", "shift"]);
    let low = viewer.moved_from(&flown);
    let height = low.pose.eye.z - tiles.ground_at(low.pose.eye.truncate()).unwrap();
    assert!((1.0..10.0).contains(&height), "{height} m above the ground");

    // The time of day by its slider: later in the day.
    let time = |viewer: &Viewer<'_>| {
        viewer.frames().last().unwrap()["sun_time"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    let noon = time(&viewer);
    viewer.drag("1", DVec2::new(112.0, 86.0), DVec2::new(150.0, 86.0));
    viewer.at_rest(|frame| frame["sun_time"] != noon.as_str());
    let later = time(&viewer);
    assert!(later > noon, "{noon} became {later}");

    // An image of what is shown.
    display.xdotool(&["key", "p"]);
    let image = folder.path().join("city-001.png");
    let start = Instant::now();
    while !image.exists() && start.elapsed() < Duration::from_secs(30) {
        std::thread::sleep(Duration::from_millis(50));
    }
    std::thread::sleep(Duration::from_millis(300));
    let (width, height) = image::image_dimensions(&image).unwrap();
    assert_eq!([width, height], SIZE);

    assert_eq!(viewer.close(), Some(0), "closing ends the program with status 0");
}

/// A building is selected, deleted and brought back; another one is drawn; the dataset says so. A length is measured, a flight set
/// and played.
#[test]
fn buildings_are_edited_in_the_window() {
    let Some(display) = Display::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let city = support::copied(folder.path());
    let dataset = city.join("buildings.gpkg");
    let before = records(&dataset);
    let mut renderer = Renderer::open(
        Gpu::open().unwrap(),
        &City::open(&city).unwrap(),
        TerrainMesh::Tin,
    )
    .unwrap();
    renderer.load_finest().unwrap();
    let tiles = &renderer.resident.tiles;
    let mut viewer = Viewer::open(&display, &city, folder.path());
    let view = viewer.at_rest(|frame| frame["generation"] == 0);
    let fid_at = |position: DVec2| {
        let hit = pick(tiles, view.pose.eye, view.direction_at(position));
        hit.map_or(0, |hit| hit.fid)
    };
    // A building well inside its own pixels.
    let at = (0..4000)
        .map(|k| DVec2::new(f64::from(300 + (k % 50) * 6), f64::from(140 + (k / 50) * 2)))
        .find(|&at| {
            let around = [[0.0, 0.0], [2.0, 0.0], [-2.0, 0.0], [0.0, 2.0], [0.0, -2.0]];
            fid_at(at) != 0
                && around
                    .iter()
                    .all(|&[x, y]| fid_at(at + DVec2::new(x, y)) == fid_at(at))
        })
        .expect("a building is in view");
    let fid = fid_at(at);
    let field = |name: &'static str, wanted: u64| {
        move |frames: &[Value]| {
            frames
                .last()
                .is_some_and(|frame| frame[name].as_u64() == Some(wanted))
        }
    };

    viewer.click(at);
    viewer.wait_for("selection", field("selected", u64::from(fid)));
    display.xdotool(&["key", "Delete"]);
    viewer.wait_for("deletion", field("generation", 1));
    let deleted = records(&dataset);
    assert_eq!(deleted.len() + 1, before.len());
    assert!(!deleted.contains_key(&u64::from(fid)));
    display.xdotool(&["key", "ctrl+z"]);
    viewer.wait_for("undo", field("generation", 2));
    assert!(records(&dataset) == before, "undone: the dataset is the first");
    display.xdotool(&["key", "ctrl+shift+z"]);
    viewer.wait_for("redo", field("generation", 3));
    assert!(records(&dataset) == deleted, "redone");

    // Four corners on the ground in the foreground, and Enter.
    display.xdotool(&["key", "b"]);
    for corner in [[300.0, 330.0], [380.0, 320.0], [400.0, 345.0], [310.0, 352.0]] {
        viewer.click(DVec2::from_array(corner));
    }
    display.xdotool(&["key", "Return"]);
    viewer.wait_for("new building", field("generation", 4));
    let drawn = records(&dataset);
    let new: Vec<_> = drawn.keys().filter(|fid| !deleted.contains_key(fid)).collect();
    assert_eq!(new.len(), 1);
    assert_eq!(drawn[new[0]].fields["height_m"].as_deref(), Some("9"));
    assert!(
        drawn
            .iter()
            .filter(|(fid, _)| *fid != new[0])
            .all(|(fid, record)| deleted[fid] == *record)
    );
    display.xdotool(&["key", "Escape"]);

    // A length between two points, as the CPU twin has them.
    let ends = [DVec2::new(330.0, 250.0), DVec2::new(480.0, 300.0)];
    display.xdotool(&["key", "m"]);
    viewer.click(ends[0]);
    viewer.click(ends[1]);
    viewer.wait_for("length", |frames| {
        frames
            .last()
            .is_some_and(|frame| frame["measured_m"].as_f64() > Some(0.0))
    });
    let measured = viewer.frames().last().unwrap()["measured_m"].as_f64().unwrap();
    let [a, b] = ends.map(|at| point_under(tiles, &view, at));
    assert!(
        (measured - a.distance(b)).abs() < 0.5,
        "{measured} m, by the twin {}",
        a.distance(b)
    );
    display.xdotool(&["key", "Escape"]);

    // Two keys of a flight, and it is played from the first.
    display.xdotool(&["key", "k"]);
    viewer.wait_for("first key", field("path_keys", 1));
    display.xdotool(&["keydown", "w"]);
    std::thread::sleep(Duration::from_millis(500));
    display.xdotool(&["keyup", "w"]);
    let moved = viewer.moved_from(&view);
    display.xdotool(&["key", "k"]);
    viewer.wait_for("second key", field("path_keys", 2));
    display.xdotool(&["key", "space"]);
    let near_first = |frame: &Value| {
        vector(&frame["eye"]).distance(view.pose.eye) < 0.25 * moved.pose.eye.distance(view.pose.eye)
    };
    viewer.wait_for("flight from its first key", |frames| {
        frames.last().is_some_and(near_first)
    });
    viewer.at_rest(|frame| vector(&frame["eye"]).distance(moved.pose.eye) < 0.01);
    display.xdotool(&["key", "Escape"]);
    assert_eq!(viewer.close(), Some(0));
    is_a_fresh_import(&city, folder.path());
}

/// A city that is updated while its window is open is shown as it is then.
#[test]
fn an_open_window_shows_an_update() {
    let Some(display) = Display::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let city = support::copied(folder.path());
    let mut viewer = Viewer::open(&display, &city, folder.path());
    viewer.at_rest(|frame| frame["generation"] == 0);
    support::succeed(&[
        "update".as_ref(),
        city.as_os_str(),
        "--delete".as_ref(),
        "100,200".as_ref(),
    ]);
    let begun = Instant::now();
    viewer.wait_for("frame of the updated city", |frames| {
        frames.last().is_some_and(|frame| frame["generation"] == 1)
    });
    println!("shown {:?} after the update", begun.elapsed());
    assert_eq!(viewer.close(), Some(0));
}

/// Without a city there is a window as well: it looks into survey files, and closes by its key.
#[test]
fn a_window_without_a_city_looks_into_survey_files() {
    let Some(display) = Display::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let files = support::sample().join("files");
    let mut program = Command::new(support::PROGRAM)
        .arg("fly")
        .args([files.join("terrain.tif"), files.join("buildings.gpkg")])
        .env("DISPLAY", &display.name)
        .env("XDG_STATE_HOME", folder.path())
        .env_remove("WAYLAND_DISPLAY")
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let mut window = String::new();
    while window.is_empty() && begun.elapsed() < Duration::from_secs(60) {
        assert!(program.try_wait().unwrap().is_none(), "the program ended");
        std::thread::sleep(Duration::from_millis(100));
        window = display.xdotool(&["search", "--name", "Rilievo"]);
    }
    std::thread::sleep(Duration::from_millis(800));
    display.xdotool(&["windowfocus", "--sync", &window]);
    display.xdotool(&["key", "Escape"]);
    while program.try_wait().unwrap().is_none() && begun.elapsed() < Duration::from_secs(90) {
        std::thread::sleep(Duration::from_millis(50));
    }
    let status = program.try_wait().unwrap();
    let _ = program.kill();
    assert_eq!(status.and_then(|status| status.code()), Some(0));
}

/// What is told of survey files before they are imported.
#[test]
fn survey_files_are_told_apart() {
    let files = support::sample().join("files");
    let told = |name: &str| identify(&files.join(name)).unwrap();
    let terrain = told("terrain.tif");
    assert_eq!(terrain.kind, SurveyKind::Terrain);
    assert!(terrain.crs.is_some_and(|crs| crs.contains("EPSG")));
    let buildings = told("buildings.gpkg");
    assert_eq!(buildings.kind, SurveyKind::Footprints);
    assert!(
        buildings.holds.iter().any(|line| line.contains("height_m")),
        "{:?}",
        buildings.holds
    );
    assert_eq!(told("photo_0_0.tif").kind, SurveyKind::Imagery);
    let other = tempfile::NamedTempFile::new().unwrap();
    assert!(identify(other.path()).is_err());
}

/// Without a display the reason is said, with status 1.
#[test]
fn without_a_display_the_reason_is_said() {
    let city = support::sample().join("city");
    let output = Command::new(support::PROGRAM)
        .arg("fly")
        .arg(&city)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        error.contains("window") && error.contains("rilievo render"),
        "{error}"
    );
}
