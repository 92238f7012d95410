//! Frame times of the viewer: every method over its baseline, with its look-ups, its operations and its error.

#[cfg(feature = "view")]
pub use with_viewer::{check, measure};
#[cfg(not(feature = "view"))]
pub use without_viewer::{check, measure};

#[cfg(not(feature = "view"))]
mod without_viewer {
    use crate::exit::{Exit, Failure};
    use crate::report::document::Document;
    use crate::report::settings::Settings;

    /// Says why the report cannot be made.
    pub fn check(_: &Settings) -> Result<(), Failure> {
        Err(Failure::new(Exit::Unsupported, "this build has no viewer; build with --features view"))
    }

    /// Refuses.
    pub fn measure(settings: &Settings) -> Result<Document, Failure> {
        Err(check(settings).expect_err("there is no viewer"))
    }
}

#[cfg(feature = "view")]
mod with_viewer {
    use crate::exit::{Exit, Failure};
    use crate::report::document::Document;
    use crate::report::settings::Settings;
    use crate::report::table::Table;
    use glint_bake_core::lobes::options::default_cell;
    use glint_bake_core::ndf_maps::options::{Options as NdfMapsOptions, PlacementOptions, StochasticOptions};
    use glint_bake_core::progress::Silent;
    use glint_bake_core::surface::{ALIGNMENT, SurfaceOptions};
    use glint_bake_core::synthesis::{SynthesisOptions, Target};
    use glint_bake_core::{area_light, dictionary, environment, lobes, ndf_maps, surface};
    use glint_formats::{Codec, Limits, Pack, PackBuilder, Section};
    use glint_view::bench::{BenchRow, BenchSettings, Setup, measure as measure_setup, table};
    use glint_view::gpu::{AdapterChoice, Gpu};
    use glint_view::scene::{Mesh, Orbit};
    use glint_view::settings::Settings as ViewSettings;
    use glint_view::subjects::Subjects;

    const SCRATCHES: &str = "tiny/scratches_32x32.png";
    const FLAKES: &str = "tiny/flakes_8x8.png";
    const LEATHER: &str = "normals/leather_008_3dtextures.jpg";
    const GOLD: &str = "normals/scratched_gold_cgbookcase_rgba.png";
    const BRUSHED: &str = "normals/brushed_aluminium_godot_745.png";
    const SKY: &str = "hdri/dancing_hall_1k.hdr";
    /// Edge of the part of a large map that becomes lobes.
    const PART: u32 = 256;
    const QUICK_PART: u32 = 128;

    /// Makes the sections of one pack.
    type Bake = fn(&Settings) -> Result<Vec<Section>, Failure>;

    /// The packs, in the order of the table.
    const PACKS: [(&str, Bake); 10] = [
        ("dictionary", bake_dictionary),
        ("NDF maps, tiled", |settings| {
            bake_ndf_maps(settings, SCRATCHES, &PlacementOptions::Tiled(Default::default()))
        }),
        ("NDF maps, placed at random", |settings| {
            bake_ndf_maps(settings, FLAKES, &PlacementOptions::Stochastic(StochasticOptions::default()))
        }),
        ("lobes, k = 32", |settings| bake_lobes(settings, 32)),
        ("lobes, k = 16", |settings| bake_lobes(settings, 16)),
        ("surface of patches", bake_surface),
        ("environment, K = 4", |settings| bake_environment(settings, 4)),
        ("environment, K = 8", |settings| bake_environment(settings, 8)),
        ("area light", |settings| bake_area_light(settings, LEATHER, false)),
        ("area light, anisotropic", |settings| bake_area_light(settings, BRUSHED, true)),
    ];

    /// Says why the report cannot be made.
    pub fn check(settings: &Settings) -> Result<(), Failure> {
        settings.check([SCRATCHES, FLAKES, LEATHER, GOLD, BRUSHED, SKY])?;
        adapter(settings).map(|_| ())
    }

    fn adapter(settings: &Settings) -> Result<Gpu, Failure> {
        Ok(Gpu::headless(&AdapterChoice { name: settings.adapter.clone() })?)
    }

    /// Measures the report.
    pub fn measure(settings: &Settings) -> Result<Document, Failure> {
        let gpu = adapter(settings)?;
        let (width, height) = settings.size.unwrap_or(settings.pick((1280, 720), (64, 36)));
        let usual = BenchSettings::default();
        let bench = BenchSettings {
            size: [width, height],
            frames: settings.frames.unwrap_or(settings.pick(20, 1)),
            reference_samples: settings.pick(usual.reference_samples, 2),
            error_size: settings.pick(usual.error_size, [32, 18]),
        };
        let mut rows = Vec::new();
        for (name, bake) in PACKS {
            settings.terminal.say(&format!("frames: {name}"));
            rows.extend(measure_pack(&gpu, &pack(bake(settings)?)?, bench)?);
        }
        let mut document = Document::new("frames", "Frame times: speed against error", settings);
        document.paragraph(
            "A wall fills the picture, from straight ahead (a pixel spans two texels of maps; of a dictionary's cells, halfway \
             between two levels of detail) and from 60° to the side, in the light that the method is made for.",
        );
        document.paragraph(
            "- *ratio*: median time of a frame, its passes over surface and display, over that of the baseline's, whose frames \
             take turns with the method's. *surface alone*: the same of the surface's pass.\n\
             - *look-ups*: elements of tables and filtered texels that a pixel reads, counted by the program, mean over the \
             picture.\n\
             - *operations*: arithmetic that a pixel executes, and its baseline's, counted by the program likewise: sums, \
             products, comparisons, conversions as one for each component, divisions, roots, exponentials as four; sides of \
             branches that are not taken count nothing.\n\
             - *instructions*: of the whole program as SPIR-V, all lights, both sides of branches, and what constants leave out.\n\
             - *error*: sum over pixels of the luminance's difference from the method's reference over the sum of the \
             reference's; of single pixels, not of their distribution, so sparse glints weigh heavily, and the reference's own \
             noise of its samples is in it.\n\
             - *noise*: that noise, half the difference between the means of the reference's first and second half.",
        );
        document.paragraph("What bounds each, a pixel:");
        document.table(&bounds());
        document.paragraph(
            "A software adapter has no texture units: a look-up is many instructions there. It executes both sides of branches \
             and the longest of eight pixels' loops for all of them, and has no fixed costs of a frame to divide by. What of a \
             ratio is look-ups and divergence does not stand for a GPU; its counts do.",
        );
        document.paragraph(format!(
            "{}, {width} x {height}, {} frames of each view, {} samples of the reference.",
            gpu.adapter_line(),
            bench.frames,
            bench.reference_samples
        ));
        document.paragraph(table(&rows));
        Ok(document)
    }

    fn bounds() -> Table {
        let mut table = Table::new(3, "method | loads and fetches | arithmetic");
        table.row("smooth | none | an exponential");
        table.row(
            "dictionary | two 4-byte loads a cell, for all cells under the footprint on two levels | a cell: its hash, three \
             rounds of integer products in a row; a rotation",
        );
        table.row(
            "NDF maps | a node: one 16-byte load of its place, one gather of four texels; three nodes a probe, of two levels in one \
             probe of a footprint; random placement: one to four examples a probe, and for each one 16-byte load of its owner and two \
             of its transform; a patch of the map below the finest windows: one 16-byte load of its four normals; one word of a mask outside \
             the highlight | a node: a bilinear blend; a patch: exponentials and error functions",
        );
        table.row(
            "lobes, surfaces | one 8-byte load a bilinear patch of the finest level and one more for each row of them, one \
             16-byte load a lobe of the others; surfaces: an offset and paths of seams besides, of one patch for a footprint's \
             boxes and of one for each cell | a lobe: a 2 × 2 inverse, two exponentials",
        );
        table.row(
            "environment | smooth: a cube and a table; glints: one cube more for every four levels | a hash for a word; a \
             word and a binomial draw for each level but one, and one word more",
        );
        table.row(
            "area light | as plain LTC: one map (two with directions), two tables | a power and two roots more than plain LTC, \
             once a lobe",
        );
        table
    }

    /// Every entry of a pack that has a baseline, from both sides.
    fn measure_pack(gpu: &Gpu, pack: &Pack, bench: BenchSettings) -> Result<Vec<BenchRow>, Failure> {
        let subjects = Subjects::of_packs(gpu, &[pack], &[])?;
        let view = ViewSettings::new(&subjects.shown, Orbit::fit(Mesh::plane(2.0).bounds()));
        let mut rows = Vec::new();
        for index in 0..subjects.shown.len() {
            for setup in Setup::of(&subjects.shown, index, &view, bench, subjects.environment.is_some()) {
                rows.push(measure_setup(gpu, &subjects, &setup, bench)?);
            }
        }
        Ok(rows)
    }

    fn pack(sections: Vec<Section>) -> Result<Pack, Failure> {
        let fault = |what: String| {
            Failure::new(Exit::Unexpected, format!("a pack cannot be built: {what}; please report this"))
        };
        let mut builder = PackBuilder::new();
        for section in sections {
            builder.push(section).map_err(|error| fault(error.to_string()))?;
        }
        let bytes = builder.finish().map_err(|error| fault(error.to_string()))?;
        Pack::from_bytes(bytes, &Limits::default()).map_err(|issues| fault(format!("{issues:?}")))
    }

    fn bake_dictionary(_: &Settings) -> Result<Vec<Section>, Failure> {
        let baked = dictionary::bake(&Default::default(), &Silent)?;
        let quality = dictionary::quality::measure(&baked);
        Ok(dictionary::sections::to_sections("dictionary", &baked, quality, Codec::None))
    }

    fn bake_ndf_maps(settings: &Settings, file: &str, placement: &PlacementOptions) -> Result<Vec<Section>, Failure> {
        let map = settings.normal_map(file, None)?;
        let options = NdfMapsOptions { maps: Default::default(), placement: *placement };
        let material = ndf_maps::bake::bake(&map, &options, &Silent)?;
        Ok(ndf_maps::sections::to_sections(stem(file), &material, Codec::None))
    }

    fn bake_lobes(settings: &Settings, lobes_per_cell: u32) -> Result<Vec<Section>, Failure> {
        let part = settings.pick(PART, QUICK_PART);
        let map = settings.normal_map(LEATHER, Some(part))?;
        let cell_texels = default_cell(part, part);
        let options =
            lobes::LobesOptions { lobes_per_cell, cell_texels, footprints: 0, ..lobes::LobesOptions::default() };
        let baked = lobes::bake(&map, &options, &Silent)?;
        Ok(lobes::sections::to_sections(&format!("leather, k = {lobes_per_cell}"), &baked, Codec::None))
    }

    fn bake_surface(settings: &Settings) -> Result<Vec<Section>, Failure> {
        let map = settings.normal_map(GOLD, Some(settings.pick(PART, QUICK_PART)))?;
        let edge = settings.pick(4096, 512);
        let target = Target::Patches { width: edge, height: edge };
        let synthesis = SynthesisOptions { target, alignment: ALIGNMENT, seed: 1, ..SynthesisOptions::default() };
        let lobes = lobes::LobesOptions { cell_texels: 8, footprints: 0, ..lobes::LobesOptions::default() };
        let baked = surface::bake(&map, &SurfaceOptions { lobes, synthesis }, &Silent)?;
        Ok(surface::sections::to_sections(stem(GOLD), &baked, Codec::None))
    }

    fn bake_environment(settings: &Settings, levels: u32) -> Result<Vec<Section>, Failure> {
        let image = settings.environment(&settings.data(SKY)?)?;
        let options = environment::EnvironmentOptions {
            levels: environment::LevelCount::Exactly(levels),
            face_size: settings.pick(256, 32),
            measured_reads: 0,
            ..environment::EnvironmentOptions::default()
        };
        let baked = environment::bake(&image, &options, &Silent)?;
        Ok(environment::sections::to_sections(&format!("dancing_hall_K{levels}"), &baked, Codec::None))
    }

    fn bake_area_light(settings: &Settings, file: &str, anisotropic: bool) -> Result<Vec<Section>, Failure> {
        let map = settings.normal_map(file, settings.pick(None, Some(QUICK_PART)))?;
        let options = area_light::AreaLightOptions { anisotropic, ..Default::default() };
        let baked = area_light::bake(&map, &options, &Silent)?;
        Ok(area_light::sections::to_sections(stem(file), &baked, Codec::None))
    }

    /// Name of a file without folder and ending.
    fn stem(file: &str) -> &str {
        let name = file.rsplit('/').next().unwrap_or(file);
        name.split('.').next().unwrap_or(name)
    }
}
