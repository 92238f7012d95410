//! egui between the window and the device: events in, shapes out, with the picture of the scene as background.

use crate::gpu::Gpu;
use std::sync::Arc;
use std::time::Duration;
use winit::event::WindowEvent;
use winit::window::Window;

/// egui's state for one window on one device.
pub(super) struct Interface {
    state: egui_winit::State,
    renderer: egui_wgpu::Renderer,
    picture: Option<egui::TextureId>,
}

/// Shapes of a frame, and when egui wants the next.
pub(super) struct Shapes {
    jobs: Vec<egui::ClippedPrimitive>,
    /// Textures that are not needed after this frame.
    free: Vec<egui::TextureId>,
    pixels_per_point: f32,
    /// Time after which egui wants to be drawn again.
    pub repaint_after: Duration,
}

impl Interface {
    pub fn new(gpu: &Gpu, window: &Arc<Window>, format: wgpu::TextureFormat) -> Interface {
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        let state = egui_winit::State::new(
            context,
            egui::ViewportId::ROOT,
            window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        let options = egui_wgpu::RendererOptions { dithering: false, ..Default::default() };
        Interface { state, renderer: egui_wgpu::Renderer::new(&gpu.device, format, options), picture: None }
    }

    /// Whether egui kept the event for itself, and whether it wants to be drawn.
    pub fn event(&mut self, window: &Window, event: &WindowEvent) -> egui_winit::EventResponse {
        self.state.on_window_event(window, event)
    }

    /// Whether keys go into a text field.
    pub fn takes_keys(&self) -> bool {
        self.state.egui_ctx().egui_wants_keyboard_input()
    }

    /// Shows another texture behind the panel.
    pub fn set_picture(&mut self, gpu: &Gpu, picture: &wgpu::TextureView) {
        if let Some(old) = self.picture.take() {
            self.renderer.free_texture(&old);
        }
        self.picture = Some(self.renderer.register_native_texture(&gpu.device, picture, wgpu::FilterMode::Nearest));
    }

    /// Runs the panel and brings its textures to the device.
    pub fn run(&mut self, gpu: &Gpu, window: &Window, mut panel: impl FnMut(&egui::Context)) -> Shapes {
        let input = self.state.take_egui_input(window);
        let context = self.state.egui_ctx().clone();
        let mut output = context.run_ui(input, |ui| panel(ui.ctx()));
        self.state.handle_platform_output(window, output.platform_output);
        let delay = output.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                self.renderer.update_texture(&gpu.device, &gpu.queue, *id, delta);
            }
        }
        let free = output.textures_delta.free.iter().copied().collect();
        // egui panics where a delta is dropped that nobody has taken.
        output.textures_delta.clear();
        Shapes {
            jobs: context.tessellate(output.shapes, output.pixels_per_point),
            free,
            pixels_per_point: output.pixels_per_point,
            repaint_after: delay.unwrap_or(Duration::MAX),
        }
    }

    /// Draws the picture and the shapes over all of `target` with `size` pixels.
    pub fn draw(&mut self, gpu: &Gpu, target: &wgpu::TextureView, size: [u32; 2], shapes: Shapes) {
        let screen = egui_wgpu::ScreenDescriptor { size_in_pixels: size, pixels_per_point: shapes.pixels_per_point };
        let mut jobs: Vec<egui::ClippedPrimitive> = self.background(&screen).into_iter().collect();
        jobs.extend(shapes.jobs);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut buffers = self.renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &jobs, &screen);
        {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("panel"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            self.renderer.render(&mut pass.forget_lifetime(), &jobs, &screen);
        }
        buffers.push(encoder.finish());
        gpu.queue.submit(buffers);
        for id in &shapes.free {
            self.renderer.free_texture(id);
        }
    }

    /// A rectangle over all pixels with the picture.
    fn background(&self, screen: &egui_wgpu::ScreenDescriptor) -> Option<egui::ClippedPrimitive> {
        let [width, height] = screen.size_in_pixels.map(|pixels| pixels as f32 / screen.pixels_per_point);
        let rect = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width, height));
        let mut mesh = egui::Mesh::with_texture(self.picture?);
        let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        mesh.add_rect_with_uv(rect, whole, egui::Color32::WHITE);
        Some(egui::ClippedPrimitive { clip_rect: rect, primitive: egui::epaint::Primitive::Mesh(mesh) })
    }
}
