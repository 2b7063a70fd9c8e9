//! What the mouse and the keys do.

use std::time::Instant;

use glam::{DVec2, DVec3};
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{KeyCode, PhysicalKey};

use super::Cursor;
use super::app::Running;
use super::screen::Screen;
use crate::space::Pose;

/// Shortest flight of a key that is tapped; longest between two frames: a pause is no flight. Seconds.
const MIN_FLIGHT_S: f64 = 0.05;
pub(super) const MAX_FLIGHT_S: f64 = 0.25;

/// Pixels of a touchpad that are a step of a wheel.
const PIXELS_PER_STEP: f64 = 40.0;

impl Running {
    /// Everything but drawing and closing; true when the window is to be closed.
    pub(super) fn on_event(&mut self, event: &WindowEvent) -> bool {
        let Screen { window, overlay, .. } = &mut self.screen;
        let is_taken = overlay.on_event(window, event);
        self.screen.window.request_redraw();
        let tiles = &self.renderer.resident.tiles;
        match event {
            WindowEvent::Resized(size) => {
                self.screen.resize(&self.renderer.gpu, [size.width, size.height]);
                self.moved();
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.cursor = DVec2::new(position.x, position.y);
                if self.state.navigator.is_dragging() {
                    let projection = self.state.projection(self.screen.size());
                    let cursor = Cursor {
                        projection: &projection,
                        position: self.cursor,
                    };
                    if self.state.navigator.drag(tiles, cursor) {
                        self.moved();
                    }
                }
            }
            WindowEvent::MouseInput {
                state: ElementState::Released,
                ..
            } => self.state.navigator.end_drag(),
            WindowEvent::MouseInput { button, .. } if !is_taken => {
                let projection = self.projection();
                let cursor = Cursor {
                    projection: &projection,
                    position: self.cursor,
                };
                match button {
                    MouseButton::Left => self.state.navigator.begin_pan(tiles, cursor),
                    MouseButton::Right => self.state.navigator.begin_orbit(tiles, cursor),
                    _ => {}
                }
            }
            WindowEvent::MouseWheel { delta, .. } if !is_taken => {
                let steps = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_STEP,
                };
                let projection = self.projection();
                let cursor = Cursor {
                    projection: &projection,
                    position: self.cursor,
                };
                if self.state.navigator.zoom(tiles, cursor, steps) {
                    self.moved();
                }
            }
            WindowEvent::Focused(false) => self.keys.clear(),
            WindowEvent::KeyboardInput { event, .. } => {
                let PhysicalKey::Code(key) = event.physical_key else {
                    return false;
                };
                let is_pressed = event.state == ElementState::Pressed;
                if !is_pressed && self.keys.contains(&key) {
                    // A tap shorter than a frame leads somewhere as well.
                    let seconds = self.last_frame.elapsed().as_secs_f64();
                    self.fly(seconds.clamp(MIN_FLIGHT_S, MAX_FLIGHT_S));
                    self.last_frame = Instant::now();
                }
                self.keys.retain(|&held| held != key);
                if is_pressed && !self.screen.overlay.egui.egui_wants_keyboard_input() {
                    if is_flight_key(key) {
                        self.keys.push(key);
                    } else if !event.repeat {
                        return self.on_key(key);
                    }
                }
            }
            _ => {}
        }
        false
    }

    /// A key that does something once; true for the one that closes the window.
    fn on_key(&mut self, key: KeyCode) -> bool {
        match key {
            KeyCode::Escape => return true,
            KeyCode::KeyP => self.saves_image = true,
            KeyCode::Tab => self.shows_panel = !self.shows_panel,
            KeyCode::KeyN => {
                let pose = &mut self.state.navigator.pose;
                let level = pose.forward.truncate().length();
                *pose = Pose::looking_along(pose.eye, DVec3::new(0.0, level, pose.forward.z));
                self.moved();
            }
            _ => {}
        }
        false
    }

    /// Moves by the keys held since the last frame.
    pub(super) fn fly(&mut self, seconds: f64) {
        let held = |key: KeyCode| f64::from(u8::from(self.keys.contains(&key)));
        let wish = DVec3::new(
            held(KeyCode::KeyD) - held(KeyCode::KeyA),
            held(KeyCode::KeyE) - held(KeyCode::KeyQ),
            held(KeyCode::KeyW) - held(KeyCode::KeyS),
        );
        let is_fast = self.keys.contains(&KeyCode::ShiftLeft) || self.keys.contains(&KeyCode::ShiftRight);
        let tiles = &self.renderer.resident.tiles;
        if self.state.navigator.fly(tiles, wish, is_fast, seconds) {
            self.pace.moved(Instant::now());
        }
    }
}

/// Keys that act as long as they are held.
fn is_flight_key(key: KeyCode) -> bool {
    matches!(
        key,
        KeyCode::KeyW
            | KeyCode::KeyA
            | KeyCode::KeyS
            | KeyCode::KeyD
            | KeyCode::KeyQ
            | KeyCode::KeyE
            | KeyCode::ShiftLeft
            | KeyCode::ShiftRight
    )
}
