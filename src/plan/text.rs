//! A plan in words: what is kept, what is dropped and why, what less error would cost.

use super::choose::{Chosen, Plan};
use crate::quantities::{kib, percent};
use crate::scene::Scene;

impl Plan {
    /// The plan for a person.
    pub fn to_text(&self, scene: &Scene) -> String {
        let (width, height) = scene.image;
        let lights = scene.lights;
        let lights = [(lights.point, "point"), (lights.rectangle, "rectangle"), (lights.environment, "environment")];
        let lights: Vec<&str> = lights.iter().filter(|(there, _)| *there).map(|(_, name)| *name).collect();
        let mut text = format!(
            "scene: {width} × {height} pixels, field of view {}°, lights: {}\n",
            scene.field_of_view,
            lights.join(", ")
        );
        for chosen in &self.packs {
            text += &of_pack(chosen);
        }
        for dropped in &self.dropped {
            text += &format!("dropped: {dropped}\n");
        }
        let most = self.most_bytes.map_or(String::new(), |most| format!(" of {} allowed", kib(most)));
        text += &format!("together {}{most}\n", kib(self.bytes()));
        if !self.fits() {
            text += "this is the nearest plan that is possible: ";
            text += &self.misses().join("; ");
            text.push('\n');
        }
        text
    }

    /// Which budgets are not kept.
    fn misses(&self) -> Vec<String> {
        let miss = |chosen: &&Chosen| !chosen.fits();
        let mut all: Vec<String> = self
            .packs
            .iter()
            .filter(miss)
            .map(|chosen| {
                let (found, asked) = (percent(chosen.draft().error), percent(chosen.pack.budget));
                format!("{} has {} {found}, {asked} was asked", chosen.pack.name, chosen.pack.measure)
            })
            .collect();
        if let Some(most) = self.most_bytes.filter(|most| self.bytes() > *most) {
            all.push(format!("together {}, {} was asked", kib(self.bytes()), kib(most)));
        }
        all
    }
}

fn of_pack(chosen: &Chosen) -> String {
    let (pack, draft) = (&chosen.pack, chosen.draft());
    let mut text = format!("{} ({}): {}\n", pack.name, pack.method, pack.view);
    let (error, budget) = (percent(draft.error), percent(pack.budget));
    text += &format!("  keep     {}: {}, {} {error} of {budget}\n", draft.options, kib(draft.bytes), pack.measure);
    for dropped in &pack.dropped {
        text += &format!("  drop     {dropped}\n");
    }
    text += &match chosen.tighter() {
        Some(next) => format!(
            "  tighter  {}: {} {} for {} more\n",
            next.options,
            pack.measure,
            percent(next.error),
            kib(next.bytes - draft.bytes)
        ),
        None => "  tighter  no draft that was made has less error\n".into(),
    };
    text
}
