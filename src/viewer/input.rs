//! What the mouse and the keys do.

use std::time::Instant;

use glam::{DVec2, DVec3};
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{KeyCode, PhysicalKey};

use super::editing::EditCommand;
use super::motion::MAX_STEP_S;
use super::panels::Action;
use super::running::Running;
use super::screen::Screen;
use super::tools::Tool;
use super::{Cursor, Navigator};
use crate::city::Edit;
use crate::scene::TileSet;
use crate::space::Pose;

/// Shortest flight of a key that is tapped, seconds.
const MIN_FLIGHT_S: f64 = 0.05;

/// Pixels of a touchpad that are a step of a wheel; and steps of a pinch to twice the size.
const PIXELS_PER_STEP: f64 = 40.0;
const STEPS_PER_PINCH: f64 = 4.0;

impl Running {
    /// Everything but drawing and closing; true when the window is to be closed.
    pub(super) fn on_event(&mut self, event: &WindowEvent) -> bool {
        let Screen { window, overlay, .. } = &mut self.screen;
        let is_taken = overlay.on_event(window, event);
        self.screen.window.request_redraw();
        match event {
            WindowEvent::Resized(size) => {
                self.screen.resize(&self.renderer.gpu, [size.width, size.height]);
                self.moved();
            }
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::CursorMoved { position, .. } => {
                self.pointer.move_to(DVec2::new(position.x, position.y));
                if !self.on_drag() {
                    self.drag();
                }
            }
            WindowEvent::MouseInput {
                state: ElementState::Released,
                button,
                ..
            } => {
                self.state.navigator.end_drag();
                if *button == MouseButton::Left && !is_taken {
                    self.on_release();
                }
            }
            WindowEvent::MouseInput { button, .. } if !is_taken => self.press(*button),
            WindowEvent::MouseWheel { delta, .. } if !is_taken => {
                self.zoom(match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_STEP,
                });
            }
            WindowEvent::PinchGesture { delta, .. } if !is_taken => self.zoom(STEPS_PER_PINCH * delta),
            WindowEvent::RotationGesture { delta, .. } if !is_taken => {
                let angle = f64::from(delta.to_radians());
                self.gesture(|navigator, tiles, cursor| navigator.rotate(tiles, cursor, angle));
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
                    self.fly(seconds.clamp(MIN_FLIGHT_S, MAX_STEP_S));
                    self.last_frame = Instant::now();
                }
                self.keys.retain(|&held| held != key);
                if is_pressed && !self.screen.overlay.egui.egui_wants_keyboard_input() {
                    let is_command = self.modifiers.control_key() || self.modifiers.super_key();
                    if event.logical_key.to_text() == Some("?") {
                        // Wherever the keyboard has it.
                        self.interface.shows_help = !self.interface.shows_help;
                    } else if is_flight_key(key) && !is_command {
                        self.keys.push(key);
                    } else if !event.repeat {
                        return self.on_key(key, is_command);
                    }
                }
            }
            _ => {}
        }
        false
    }

    fn press(&mut self, button: MouseButton) {
        self.stop();
        if button == MouseButton::Left && self.on_press() {
            return;
        }
        let projection = self.projection();
        let cursor = Cursor {
            projection: &projection,
            position: self.pointer.position,
        };
        let tiles = &self.renderer.resident.tiles;
        match button {
            MouseButton::Left if self.modifiers.control_key() => {
                self.state.navigator.begin_orbit(tiles, cursor)
            }
            MouseButton::Left => self.state.navigator.begin_pan(tiles, cursor),
            MouseButton::Right => self.state.navigator.begin_orbit(tiles, cursor),
            _ => {}
        }
    }

    /// The camera follows the pointer that holds the city.
    fn drag(&mut self) {
        if !self.state.navigator.is_dragging() {
            return;
        }
        let projection = self.projection();
        let cursor = Cursor {
            projection: &projection,
            position: self.pointer.position,
        };
        let before = self.state.navigator.pose;
        if self.state.navigator.drag(&self.renderer.resident.tiles, cursor) {
            let now = self.state.navigator.pose;
            // Only a pan runs on.
            if now.forward == before.forward {
                let step = (now.eye - before.eye).truncate();
                self.momentum.dragged(step, self.pointer.step_s());
            }
            self.moved();
        }
    }

    fn zoom(&mut self, steps: f64) {
        self.gesture(|navigator, tiles, cursor| navigator.zoom(tiles, cursor, steps));
    }

    /// What the navigator does at the cursor, without anything held.
    fn gesture(&mut self, act: impl FnOnce(&mut Navigator, &TileSet, Cursor<'_>) -> bool) {
        self.stop();
        let projection = self.projection();
        let cursor = Cursor {
            projection: &projection,
            position: self.pointer.position,
        };
        let tiles = &self.renderer.resident.tiles;
        if act(&mut self.state.navigator, tiles, cursor) {
            self.moved();
        }
    }

    /// A key that does something once; true for the one that closes the window.
    fn on_key(&mut self, key: KeyCode, is_command: bool) -> bool {
        let interface = &mut self.interface;
        let action = match key {
            KeyCode::Escape => return !self.put_down(),
            KeyCode::KeyZ if is_command && self.modifiers.shift_key() => {
                Some(Action::Edit(EditCommand::Redo))
            }
            KeyCode::KeyZ if is_command => Some(Action::Edit(EditCommand::Undo)),
            KeyCode::KeyY if is_command => Some(Action::Edit(EditCommand::Redo)),
            _ if is_command => None,
            KeyCode::KeyP => Some(Action::SaveImage),
            KeyCode::KeyK => Some(Action::AddKey),
            KeyCode::Tab => {
                interface.is_hidden = !interface.is_hidden;
                None
            }
            KeyCode::F1 => Some(Action::ToggleHelp),
            KeyCode::KeyM => {
                interface.tool = other_or_look(interface.tool, Tool::Measure);
                None
            }
            KeyCode::KeyB => {
                interface.tool = other_or_look(interface.tool, Tool::Draw);
                None
            }
            KeyCode::Enter | KeyCode::NumpadEnter if interface.tool == Tool::Draw => Some(Action::Build),
            KeyCode::Delete => interface.selection.as_ref().map(|selection| {
                let fid = selection.details.building.fid;
                Action::Edit(EditCommand::Apply(Edit::Delete { fid }))
            }),
            KeyCode::KeyR => {
                interface.recorder.toggle_recording();
                None
            }
            KeyCode::Space => {
                interface.recorder.toggle_playing();
                None
            }
            KeyCode::KeyN => {
                let pose = &mut self.state.navigator.pose;
                let level = pose.forward.truncate().length();
                *pose = Pose::looking_along(pose.eye, DVec3::new(0.0, level, pose.forward.z));
                self.moved();
                None
            }
            _ => None,
        };
        if let Some(action) = action
            && let Err(error) = self.act(action)
        {
            self.tell(error.to_string());
        }
        false
    }
}

/// A tool, or looking again when it is in hand.
fn other_or_look(now: Tool, tool: Tool) -> Tool {
    if now == tool { Tool::Look } else { tool }
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
