//! The programs as a user meets them: one program of tests, so that they share their helpers and one build.

#[path = "cli/area_light.rs"]
mod area_light;
#[path = "cli/bad_input.rs"]
mod bad_input;
#[path = "cli/bake.rs"]
mod bake;
#[path = "cli/bind_pack.rs"]
mod bind_pack;
#[path = "cli/build.rs"]
mod build;
#[path = "cli/build_real.rs"]
mod build_real;
#[path = "cli/compare.rs"]
mod compare;
#[path = "cli/damage.rs"]
mod damage;
#[path = "cli/dictionary.rs"]
mod dictionary;
#[path = "cli/documentation.rs"]
mod documentation;
#[path = "cli/documentation_commands.rs"]
mod documentation_commands;
#[path = "cli/environment.rs"]
mod environment;
#[path = "cli/examples.rs"]
mod examples;
#[path = "cli/export.rs"]
mod export;
#[path = "real_maps/folder.rs"]
mod folder;
#[path = "cli/foreign.rs"]
mod foreign;
#[path = "cli/generate.rs"]
mod generate;
#[path = "cli/glints.rs"]
mod glints;
#[path = "cli/gltf_file.rs"]
mod gltf_file;
#[path = "cli/info.rs"]
mod info;
#[path = "cli/inputs_build.rs"]
mod inputs_build;
#[path = "cli/inputs_exr.rs"]
mod inputs_exr;
#[path = "cli/inputs_files.rs"]
mod inputs_files;
#[path = "cli/inputs_meaning.rs"]
mod inputs_meaning;
#[cfg(feature = "view")]
#[path = "cli/inputs_mesh.rs"]
mod inputs_mesh;
#[path = "cli/inputs_radiance.rs"]
mod inputs_radiance;
#[path = "cli/inputs_raster.rs"]
mod inputs_raster;
#[path = "cli/lobes.rs"]
mod lobes;
#[path = "cli/ninja.rs"]
mod ninja;
#[path = "cli/pipelines.rs"]
mod pipelines;
#[path = "cli/plan.rs"]
mod plan;
#[path = "cli/preview.rs"]
mod preview;
#[path = "cli/projects.rs"]
mod projects;
#[path = "cli/read_pack.rs"]
mod read_pack;
#[path = "cli/report.rs"]
mod report;
#[path = "cli/schema.rs"]
mod schema;
#[path = "cli/shaders.rs"]
mod shaders;
#[path = "cli/shipped_maps.rs"]
mod shipped_maps;
#[path = "cli/support.rs"]
mod support;
#[path = "cli/surface.rs"]
mod surface;
#[path = "cli/textures.rs"]
mod textures;
#[path = "cli/textures_alpha.rs"]
mod textures_alpha;
#[path = "cli/textures_flags.rs"]
mod textures_flags;
#[path = "cli/textures_gltf.rs"]
mod textures_gltf;
#[path = "cli/textures_gltf_coat.rs"]
mod textures_gltf_coat;
#[path = "cli/textures_project.rs"]
mod textures_project;
#[path = "cli/textures_readers.rs"]
mod textures_readers;
#[path = "cli/textures_udim.rs"]
mod textures_udim;
#[cfg(feature = "view")]
#[path = "cli/view.rs"]
mod view;
#[cfg(feature = "view")]
#[path = "cli/view_textures.rs"]
mod view_textures;
