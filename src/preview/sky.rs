//! The surroundings: a dim studio that lets shapes read as shapes, smooth so that it needs no blur.

use glam::Vec3;

/// Radiance from a unit direction.
pub fn radiance(direction: Vec3) -> Vec3 {
    let up = direction.y;
    let floor = Vec3::new(0.030, 0.029, 0.030);
    let horizon = Vec3::new(0.105, 0.115, 0.140);
    let zenith = Vec3::new(0.040, 0.046, 0.065);
    let vertical =
        if up < 0.0 { horizon.lerp(floor, smooth(-up / 0.95)) } else { horizon.lerp(zenith, smooth(up / 0.9)) };
    // A large soft box overhead to the left, and a cool glow from behind to the right.
    let key = smooth((direction.dot(Vec3::new(-0.45, 0.80, 0.40)) - 0.25) / 0.75);
    let rim = smooth((direction.dot(Vec3::new(0.80, 0.25, -0.55)) - 0.25) / 0.75);
    vertical + Vec3::new(0.40, 0.385, 0.36) * key + Vec3::new(0.13, 0.20, 0.33) * rim
}

/// What is seen where nothing stands: a wall that darkens towards its edges.
pub fn backdrop(across: f32, down: f32) -> Vec3 {
    let middle = Vec3::new(0.050, 0.056, 0.070);
    let corner = Vec3::new(0.008, 0.009, 0.012);
    let distance = (across * across + (down - 0.1) * (down - 0.1)).sqrt();
    middle.lerp(corner, smooth(distance / 1.25))
}

/// 0 below 0, 1 above 1, smooth between.
pub fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
