//! Pictures out of a video, by the system's ffmpeg.

use std::path::Path;
use std::process::{Command, Stdio};

/// Containers that name no other file and no server.
const CONTAINERS: &str = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,mxf,dv";

/// The picture at a time, seconds from the video's beginning, as a PNG file's bytes. The error says why there is none.
pub fn video_frame(video: &Path, at_s: f64) -> Result<Vec<u8>, String> {
    let output = Command::new("ffmpeg")
        .args(["-hide_banner", "-loglevel", "error", "-nostdin"])
        .args(["-protocol_whitelist", "file", "-format_whitelist", CONTAINERS])
        .args(["-ss", &at_s.to_string(), "-i"])
        // A name that begins with a dash or names a protocol is a file all the same.
        .arg(format!("file:{}", video.display()))
        .args(["-frames:v", "1", "-an", "-f", "image2pipe", "-c:v", "png"])
        .args(["-pix_fmt", "rgb24", "pipe:1"])
        .stdin(Stdio::null())
        .output()
        .map_err(|why| {
            format!("a video needs ffmpeg, which cannot be run ({why}); install it, or give photos")
        })?;
    if output.status.success() && !output.stdout.is_empty() {
        return Ok(output.stdout);
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(match said.lines().last() {
        Some(line) => format!("ffmpeg reads no picture at {at_s} s ({line})"),
        None => format!("has no picture at {at_s} s"),
    })
}
