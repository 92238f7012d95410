// A surface of counted facets: all lights of the scene draw from the facets that are found once. Its reference is the mean over seeds.

#import shade_environment_surface
#import shade_environment_levels
#import environment::eval
#import bind_glints
#import shade_rect_light

// Points that are on, besides the directional light.
override GLINTS_POINTS: u32 = 0u;
// What a material has; false leaves its part out of the program.
override GLINTS_COLOURED: bool = true;
override GLINTS_TURNED: bool = true;
override GLINTS_PARTIAL: bool = true;
// Whether facets lie in space and not in uv.
override GLINTS_IN_SPACE: bool = false;
override GLINTS_DIFFUSE: bool = true;
override GLINTS_COATED: bool = true;

// Small lights and rectangles that are on.
fn shade_glints_count() -> u32 {
    var count = GLINTS_POINTS;
    if (LIGHTS & VIEW_LIGHT_SUN) != 0u {
        count += 1u;
    }
    if (LIGHTS & VIEW_LIGHT_RECT) != 0u {
        count += 1u;
    }
    return count;
}

fn shade_glints_layers() -> GlintLayers {
    let layers = counted_material.layers;
    return GlintLayers(
        select(vec3f(0.0), layers.diffuse, GLINTS_DIFFUSE),
        select(0.0, layers.coat, GLINTS_COATED),
        layers.coat_alpha,
    );
}

// Where the pixel lies among facets.
fn shade_glints_plane(point: ViewPoint) -> GlintFacingPlane {
    if !GLINTS_IN_SPACE {
        return GlintFacingPlane(point.uv, point.d_dx, point.d_dy, material.seed, 1.0);
    }
    let scale = scene.uv_scale;
    return glint_facing_plane(
        point.position * scale, point.position_dx * scale, point.position_dy * scale, point.normal, material.seed,
    );
}

fn shade_glints_surface(point: ViewPoint) -> GlintCountedSurface {
    let plane = shade_glints_plane(point);
    let counted = GlintCountedMaterial(
        material.f0,
        NORMAL_TARGET,
        material.alpha,
        select(vec2f(1.0, 0.0), counted_material.turn, GLINTS_TURNED),
        select(vec3f(1.0), material.mean_colour, GLINTS_COLOURED),
        select(0u, material.colours, GLINTS_COLOURED),
        material.density * plane.area_ratio,
        select(1.0, material.relative_area, GLINTS_PARTIAL),
        material.facet_area,
        material.facet_spread,
        material.sky_spread,
        plane.seed,
        shade_glints_layers(),
    );
    return glint_counted_surface(counted, plane.position, plane.d_dx, plane.d_dy, point.view);
}

fn shade_glints_sun(point: ViewPoint, surface: GlintCountedSurface) -> GlintFacetLight {
    let light = GlintConeLight(view_to_tangent(point, scene.sun), scene.sun_irradiance, scene.sun_solid_angle);
    return glint_cone_light(surface, light);
}

fn shade_glints_point(point: ViewPoint, surface: GlintCountedSurface, index: u32) -> GlintFacetLight {
    let light = scene.points[index];
    let to_light = light.position - point.position;
    let distance2 = max(dot(to_light, to_light), 1.0e-8);
    let direction = view_to_tangent(point, to_light * inverseSqrt(distance2));
    // Of a sphere that is near, half of all directions.
    let solid_angle = 3.14159265 * min(light.radius * light.radius / distance2, 2.0);
    return glint_cone_light(surface, GlintConeLight(direction, light.intensity / distance2, solid_angle));
}

// Light `number` of those that are drawn: the directional light, the points, the rectangle. What is on is known when a pipeline is made.
fn shade_glints_light(point: ViewPoint, surface: GlintCountedSurface, number: u32) -> GlintFacetLight {
    if number >= shade_glints_count() {
        return glint_no_light();
    }
    var index = number;
    if (LIGHTS & VIEW_LIGHT_SUN) != 0u {
        if number == 0u {
            return shade_glints_sun(point, surface);
        }
        index -= 1u;
    }
    if index < GLINTS_POINTS {
        return shade_glints_point(point, surface, index);
    }
    return glint_rect_facets(surface, shade_rect_light(point));
}

fn shade_glints_four(point: ViewPoint, surface: GlintCountedSurface, first: u32) -> vec3f {
    let a = shade_glints_light(point, surface, first);
    let b = shade_glints_light(point, surface, first + 1u);
    let c = shade_glints_light(point, surface, first + 2u);
    let d = shade_glints_light(point, surface, first + 3u);
    if REFERENCE {
        return glint_mean_radiance(surface.material, a.radiance + b.radiance + c.radiance + d.radiance)
            + (a.beside + b.beside + c.beside + d.beside);
    }
    let drawn = vec4u(0u, 1u, 2u, 3u) + first < vec4u(shade_glints_count());
    return glint_four_lights(surface, a, b, c, d, drawn);
}

// What layers besides the facets reflect of the environment.
fn shade_glints_sky_layers(data: GlintEnvironment, seen: GlintSurface, surface: GlintCountedSurface) -> vec3f {
    let layers = surface.material.layers;
    var around = vec3f(0.0);
    if GLINTS_DIFFUSE {
        // The widest reflection stands for light from the half space.
        around = glint_environment_filtered(seen.normal, glint_environment_roughness(data, 1.0)).rgb;
    }
    var reflected = vec3f(0.0);
    if GLINTS_COATED {
        let coat = GlintSurface(seen.normal, seen.view, layers.coat_alpha, GLINT_COAT_F0, 0.0);
        reflected = glint_environment_smooth(data, coat);
    }
    return glint_sky_layers(layers, surface.material.f0, surface.view.z, around, reflected);
}

fn shade_glints_sky(point: ViewPoint, surface: GlintCountedSurface) -> vec3f {
    let data = shade_environment_data();
    let seen = shade_environment_point(point, surface.facets);
    let chances = glint_chances(data, seen);
    let beside = shade_glints_sky_layers(data, seen, surface);
    if REFERENCE {
        let through = glint_coat_through(surface.material.layers, surface.view.z);
        let mean = glint_mean_radiance(surface.material, chances.smooth_radiance) * through;
        return (mean + beside) * scene.environment_gain;
    }
    let drawn = glint_environment_draw(data, chances, surface.facets, glint_sky_words(surface, data.levels));
    let radiance = glint_sky_radiance(surface, drawn, chances.smooth_radiance, chances.moments);
    return (radiance + beside) * scene.environment_gain;
}

fn shade_lights(point: ViewPoint, random: vec2f) -> vec3f {
    let surface = shade_glints_surface(point);
    glint_large_counts = false;
    var radiance = vec3f(0.0);
    if shade_glints_count() > 0u {
        radiance = shade_glints_four(point, surface, 0u);
    }
    if shade_glints_count() > 4u {
        radiance += shade_glints_four(point, surface, 4u);
    }
    if (LIGHTS & VIEW_LIGHT_ENVIRONMENT) != 0u {
        radiance += shade_glints_sky(point, surface);
    }
    return radiance;
}

fn shade_lod(point: ViewPoint) -> f32 {
    let plane = shade_glints_plane(point);
    return glint_footprint_box(plane.d_dx, plane.d_dy).lod;
}
