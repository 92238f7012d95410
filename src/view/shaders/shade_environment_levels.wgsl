// The environment's data with what is known when a pipeline is made.

#import bind_environment

// Number of radiance levels of the pack, whether they have colours, look-ups of a surface, and radiances of levels: what is known when a pipeline is made costs
// neither loads nor branches, which some devices take both ways. No levels: all are read from the environment.
override ENVIRONMENT_LEVELS: u32 = 0u;
override ENVIRONMENT_COLOURED: u32 = 0u;
override ENVIRONMENT_LOOK_UPS: u32 = 1u;
override ENVIRONMENT_LEVEL_0: f32 = 0.0;
override ENVIRONMENT_LEVEL_1: f32 = 0.0;
override ENVIRONMENT_LEVEL_2: f32 = 0.0;
override ENVIRONMENT_LEVEL_3: f32 = 0.0;
override ENVIRONMENT_LEVEL_4: f32 = 0.0;
override ENVIRONMENT_LEVEL_5: f32 = 0.0;
override ENVIRONMENT_LEVEL_6: f32 = 0.0;
override ENVIRONMENT_LEVEL_7: f32 = 0.0;
override ENVIRONMENT_LEVEL_8: f32 = 0.0;
override ENVIRONMENT_LEVEL_9: f32 = 0.0;
override ENVIRONMENT_LEVEL_10: f32 = 0.0;
override ENVIRONMENT_LEVEL_11: f32 = 0.0;
override ENVIRONMENT_LEVEL_12: f32 = 0.0;
override ENVIRONMENT_LEVEL_13: f32 = 0.0;
override ENVIRONMENT_LEVEL_14: f32 = 0.0;
override ENVIRONMENT_LEVEL_15: f32 = 0.0;

// 1 for levels that there are, of `first` and the three after it.
fn shade_environment_present(first: u32) -> vec4f {
    let index = vec4u(0u, 1u, 2u, 3u) + first;
    return select(vec4f(0.0), vec4f(1.0), index < vec4u(ENVIRONMENT_LEVELS));
}

fn shade_environment_data() -> GlintEnvironment {
    var data = environment;
    if ENVIRONMENT_LEVELS != 0u {
        data.levels = ENVIRONMENT_LEVELS;
        data.coloured = ENVIRONMENT_COLOURED;
        data.look_ups = ENVIRONMENT_LOOK_UPS;
        data.level = GlintLevels(
            vec4f(ENVIRONMENT_LEVEL_0, ENVIRONMENT_LEVEL_1, ENVIRONMENT_LEVEL_2, ENVIRONMENT_LEVEL_3),
            vec4f(ENVIRONMENT_LEVEL_4, ENVIRONMENT_LEVEL_5, ENVIRONMENT_LEVEL_6, ENVIRONMENT_LEVEL_7),
            vec4f(ENVIRONMENT_LEVEL_8, ENVIRONMENT_LEVEL_9, ENVIRONMENT_LEVEL_10, ENVIRONMENT_LEVEL_11),
            vec4f(ENVIRONMENT_LEVEL_12, ENVIRONMENT_LEVEL_13, ENVIRONMENT_LEVEL_14, ENVIRONMENT_LEVEL_15),
        );
        data.present = GlintLevels(
            shade_environment_present(0u), shade_environment_present(4u),
            shade_environment_present(8u), shade_environment_present(12u),
        );
    }
    return data;
}
