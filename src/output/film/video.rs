//! Frames to a video, by the system's ffmpeg.

use std::path::Path;
use std::process::{Command, Stdio};

use super::FrameFolder;
use crate::output::OutputError;

const PROGRAM: &str = "ffmpeg";

/// Fails where there is no ffmpeg.
///
/// # Errors
/// Then, naming the file that needs it.
pub fn require_encoder(video: &Path) -> Result<(), OutputError> {
    let found = Command::new(PROGRAM)
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    match found {
        Ok(status) if status.success() => Ok(()),
        _ => Err(OutputError {
            path: video.to_owned(),
            why: "a video needs ffmpeg, which is not installed; install it, or name a folder for the frames"
                .to_owned(),
        }),
    }
}

/// Encodes all frames as H.264 in an MP4 file, which appears whole. The same frames give the same bytes.
///
/// # Errors
/// When ffmpeg fails.
pub fn encode_video(frames: &FrameFolder, frames_per_s: f64, video: &Path) -> Result<(), OutputError> {
    let error = |why: String| OutputError {
        path: video.to_owned(),
        why,
    };
    let beside = frames.video();
    let output = Command::new(PROGRAM)
        .args([
            "-hide_banner",
            "-loglevel",
            "error",
            "-nostdin",
            "-y",
            "-framerate",
        ])
        .arg(frames_per_s.to_string())
        .arg("-i")
        .arg(frames.pattern())
        // Even sides, as the colour planes of the format want them.
        .args([
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
        ])
        .args([
            "-c:v", "libx264", "-preset", "slow", "-crf", "16", "-pix_fmt", "yuv420p",
        ])
        .args([
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "iec61966-2-1",
        ])
        .args([
            "-movflags",
            "+faststart",
            "-fflags",
            "+bitexact",
            "-flags:v",
            "+bitexact",
            "-threads",
            "1",
        ])
        .args(["-f", "mp4"])
        .arg(&beside)
        .stdin(Stdio::null())
        .output()
        .map_err(|why| error(format!("ffmpeg could not be run ({why})")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let line = said.lines().last().unwrap_or("it gave no reason").to_owned();
        return Err(error(format!("ffmpeg failed ({line})")));
    }
    std::fs::rename(&beside, video).map_err(|why| error(why.to_string()))
}
