//! Films: every frame is the still of its view, the same flight gives the same bytes, what was stopped is finished.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rilievo::city::City;
use rilievo::source::read_track;
use rilievo::space::Crs;
use support::{PROGRAM, rilievo, succeed};

/// Down from an oblique view into a street, as the day ends.
const FLIGHT: &str = r#"[
  {"t": 0.0, "eye": [288900, 4772600, 400], "look": [289180, 4773000, 215], "fov": 45, "time": "2026-06-21T18:30:00+02:00"},
  {"t": 1.0, "eye": [289200, 4772950, 290], "look": [289400, 4773100, 215]},
  {"t": 2.5, "eye": [289442.35, 4773173.31, 231.1], "look": [289490.6, 4773188.1, 234.2], "fov": 62, "time": "2026-06-21T20:30:00+02:00"}
]"#;
const FPS: &str = "4";
const FRAMES: usize = 10;

fn arguments(path: &Path, out: &Path) -> Vec<String> {
    let city = support::sample().join("city");
    let text = |path: &Path| path.display().to_string();
    let mut all: Vec<String> = vec!["film".to_owned(), text(&city), "--path".to_owned(), text(path)];
    all.extend(["--fps", FPS, "--size", "96x54", "--samples", "2", "--out"].map(str::to_owned));
    all.push(text(out));
    all
}

/// What `render` gives of the flight at the time of a frame.
fn still_of(path: &Path, frame: usize, out: &Path) {
    still_of_size(path, frame, out, "96x54");
}

fn still_of_size(path: &Path, frame: usize, out: &Path, size: &str) {
    let city = support::sample().join("city").display().to_string();
    let at = (frame as f64 / 4.0).to_string();
    let [path, out] = [path, out].map(|path| path.display().to_string());
    succeed(&[
        "render",
        &city,
        "--path",
        &path,
        "--at",
        &at,
        "--size",
        size,
        "--samples",
        "2",
        "--out",
        &out,
    ]);
}

/// Names and bytes of the PNG files of a folder.
fn frames(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .unwrap()
        .flatten()
        .filter(|entry| entry.path().extension().is_some_and(|ending| ending == "png"))
        .map(|entry| {
            (
                entry.file_name().to_string_lossy().into_owned(),
                fs::read(entry.path()).unwrap(),
            )
        })
        .collect();
    found.sort();
    found
}

#[test]
fn a_film_is_its_stills_and_is_finished_after_it_was_killed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    fs::write(&path, FLIGHT).unwrap();
    let whole = folder.path().join("whole");
    succeed(&arguments(&path, &whole));
    let first = frames(&whole);
    assert_eq!(first.len(), FRAMES);
    assert!(
        first.windows(2).all(|pair| pair[0].1 != pair[1].1),
        "the camera moves"
    );

    // Each frame is what `render` gives of the flight at its time.
    for frame in [0, 3, 7, 9] {
        let still = folder.path().join("still.png");
        still_of(&path, frame, &still);
        assert!(
            fs::read(&still).unwrap() == first[frame].1,
            "frame {frame} is not its still"
        );
    }

    // Killed when some frames are there, and run again.
    let stopped = folder.path().join("stopped");
    let mut program = Command::new(PROGRAM)
        .args(arguments(&path, &stopped))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !(stopped.is_dir() && frames(&stopped).len() >= 3) && begun.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(5));
    }
    program.kill().unwrap();
    program.wait().unwrap();
    let before = frames(&stopped).len();
    succeed(&arguments(&path, &stopped));
    assert!(
        frames(&stopped) == first,
        "killed after {before} frames, then finished"
    );

    // A second run of a whole film draws nothing; another flight begins anew.
    let written = fs::metadata(whole.join("000000.png"))
        .unwrap()
        .modified()
        .unwrap();
    succeed(&arguments(&path, &whole));
    assert_eq!(
        fs::metadata(whole.join("000000.png"))
            .unwrap()
            .modified()
            .unwrap(),
        written
    );
    fs::write(&path, FLIGHT.replace("400]", "420]")).unwrap();
    succeed(&arguments(&path, &whole));
    let other = frames(&whole);
    assert_eq!(other.len(), FRAMES);
    assert!(other[0].1 != first[0].1, "another flight, other frames");
}

/// The same flight gives the same file, of all its frames.
#[test]
fn a_video_has_every_frame_and_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    fs::write(&path, FLIGHT).unwrap();
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        eprintln!("SKIPPED: ffmpeg is absent, no video was made; run tools/set-up");
        let output = rilievo(&arguments(&path, &folder.path().join("a.mp4")));
        assert_eq!(output.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&output.stderr).contains("ffmpeg"));
        return;
    }
    let videos = ["a.mp4", "b.mp4"].map(|name| {
        let video = folder.path().join(name);
        succeed(&arguments(&path, &video));
        video
    });
    let [a, b] = videos.each_ref().map(|video| fs::read(video).unwrap());
    assert!(a == b, "two runs, two files");
    let told = Command::new("ffprobe")
        .args([
            "-v",
            "error",
            "-show_entries",
            "stream=width,height,nb_frames",
            "-of",
            "csv=p=0",
        ])
        .arg(&videos[0])
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&told.stdout).trim().to_owned();
    assert_eq!(told, format!("96,54,{FRAMES}"));
    let names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .flatten()
        .map(|entry| entry.file_name())
        .collect();
    assert_eq!(names.len(), 3, "nothing is left beside the videos: {names:?}");
}

/// What is no flight is refused before anything is drawn, with the file and the reason.
#[test]
fn what_is_no_flight_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    let out = folder.path().join("frames");
    for (text, reason) in [
        ("", "list of views"),
        ("{}", "list of views"),
        ("[]", "no views"),
        (r#"[{"eye": [1, 2, 3]}]"#, "look"),
        (r#"[{"eye": [1, 2, 3], "look": [1, 2, 3]}]"#, "its own eye"),
        (r#"[{"eye": [1, 2, 3], "look": [1, 2, 4], "speed": 3}]"#, "speed"),
        (
            r#"[{"t": 1, "eye": [1, 2, 3], "look": [1, 2, 4]}, {"t": 1, "eye": [1, 2, 3], "look": [1, 2, 4]}]"#,
            "after",
        ),
        (
            r#"[{"t": 1, "eye": [1, 2, 3], "look": [1, 2, 4]}, {"eye": [1, 2, 3], "look": [1, 2, 4]}]"#,
            "to all or to none",
        ),
        (r#"[{"eye": [1, 2, 3], "look": [1, 2, 4], "fov": 400}]"#, "fov"),
        (
            r#"[{"eye": [1, 2, 3], "look": [1, 2, 4], "time": "noon"}]"#,
            "noon",
        ),
        (r#"[{"eye": [1, 2, 1e999], "look": [1, 2, 4]}]"#, "view"),
    ] {
        fs::write(&path, text).unwrap();
        let output = rilievo(&arguments(&path, &out));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{text}: {said}");
        assert!(
            said.contains("flight.json") && said.contains(reason),
            "{text}: {said}"
        );
        assert!(!out.exists(), "{text}: frames were begun");
    }
    // A folder of other things is left alone.
    fs::write(&path, FLIGHT).unwrap();
    fs::create_dir(&out).unwrap();
    fs::write(out.join("mine.txt"), "mine").unwrap();
    let output = rilievo(&arguments(&path, &out));
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("mine.txt"));
    assert_eq!(fs::read_to_string(out.join("mine.txt")).unwrap(), "mine");
}

/// Tracks of GPX and KML: where they are, how high and when, and nothing that they do not say.
#[test]
fn tracks_are_read_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let crs = City::open(&support::sample().join("city"))
        .unwrap()
        .manifest()
        .crs
        .clone();
    let crs = Crs::from_text(&crs).unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let points: Vec<String> = (0..5)
        .map(|k| {
            let (lat, lon) = (43.076 + 0.001 * f64::from(k), 12.404 + 0.001 * f64::from(k));
            format!(
                r#"<trkpt lat="{lat}" lon="{lon}"><time>2026-06-21T10:00:{:02}Z</time></trkpt>"#,
                8 * k
            )
        })
        .collect();
    let gpx = |inside: &str| {
        format!(
            r#"<?xml version="1.0"?><gpx version="1.1" creator="t" xmlns="http://www.topografix.com/GPX/1/1">{inside}</gpx>"#
        )
    };
    let track = gpx(&format!("<trk><trkseg>{}</trkseg></trk>", points.concat()));
    let track = read_track(&write("a.gpx", &track), &crs).unwrap();
    assert_eq!(track.len(), 5);
    for (k, pair) in track.windows(2).enumerate() {
        // A thousandth of a degree of latitude is 111 m, of longitude at 43 degrees 81 m.
        let step = pair[1].position - pair[0].position;
        assert!((step.length() - 137.6).abs() < 1.5, "{k}: {step}");
        assert_eq!(pair[1].time_s.unwrap() - pair[0].time_s.unwrap(), 8.0);
        assert_eq!(pair[0].elevation_m, None, "the file says no elevation");
    }
    let kml = r#"<?xml version="1.0" encoding="UTF-8"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark>
        <LineString><coordinates>12.404,43.076,350 12.405,43.077,340 12.406,43.078,330</coordinates></LineString></Placemark></Document></kml>"#;
    let line = read_track(&write("a.kml", kml), &crs).unwrap();
    assert_eq!(
        line.iter().map(|point| point.elevation_m).collect::<Vec<_>>(),
        [Some(350.0), Some(340.0), Some(330.0)]
    );
    assert!(line[0].position.distance(track[0].position) < 0.01 && line[0].time_s.is_none());
    let empty = read_track(&write("b.gpx", &gpx("")), &crs);
    assert!(empty.is_err_and(|error| error.to_string().contains("b.gpx") && error.to_string().contains("no track")));
}

/// Frames of linear radiance are the radiance of their views, and no video is made of them.
#[test]
fn frames_of_radiance_are_their_stills() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    fs::write(&path, FLIGHT).unwrap();
    let out = folder.path().join("radiance");
    let mut all = arguments(&path, &out);
    all.extend(["--frames", "exr"].map(str::to_owned));
    succeed(&all);
    let still = folder.path().join("still.exr");
    for frame in [0, 6] {
        still_of(&path, frame, &still);
        let drawn = fs::read(out.join(format!("{frame:06}.exr"))).unwrap();
        assert!(drawn == fs::read(&still).unwrap(), "frame {frame}");
    }
    let mut all = arguments(&path, &folder.path().join("film.mp4"));
    all.extend(["--frames", "exr"].map(str::to_owned));
    let refused = rilievo(&all);
    let error = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1), "{error}");
    assert!(error.contains("film.mp4"), "{error}");
}

/// A film wider than what is drawn at once has whole frames, each the still of its view.
#[test]
fn a_film_may_be_larger_than_what_is_drawn_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.json");
    fs::write(
        &path,
        r#"[
          {"t": 0.0, "eye": [288900, 4772600, 400], "look": [289180, 4773000, 215], "fov": 1},
          {"t": 0.5, "eye": [289200, 4772950, 290], "look": [289400, 4773100, 215]}
        ]"#,
    )
    .unwrap();
    let out = folder.path().join("wide");
    let size = "8300x20";
    let mut all = arguments(&path, &out);
    let at = all.iter().position(|word| word == "96x54").unwrap();
    all[at] = size.to_owned();
    succeed(&all);
    let frames = frames(&out);
    assert_eq!(frames.len(), 2);
    let still = folder.path().join("still.png");
    still_of_size(&path, 1, &still, size);
    assert!(fs::read(&still).unwrap() == frames[1].1);
    assert_eq!(image::image_dimensions(&still).unwrap(), (8300, 20));
    let refused = support::rilievo(&[
        "film", "nowhere", "--path", "x", "--out", "y", "--size", "70000x20",
    ]);
    assert_eq!(refused.status.code(), Some(2));
}
