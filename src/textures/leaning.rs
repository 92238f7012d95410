//! Where engines that take the axes of anisotropic highlights from the surface show them worse than round ones.
//!
//! Such an engine shades the whole material by lobes around the surface's normal, also where the strength is 0: mean normals of a mip
//! that lean further than the highlight is wide are lost to it, and no texture mends that. The bake knows both errors.

/// Errors that differ by less are the same to the eye, and to the samples of the fit.
const LEAST_DIFFERENCE: f32 = 0.01;

/// What the user should know of errors of mips, from 1 on, with anisotropy and without.
pub fn warning(against_round: &[[f32; 2]]) -> Option<String> {
    let worse = |[with, without]: [f32; 2]| with > 1.02 * without + LEAST_DIFFERENCE;
    let mips: Vec<usize> = (1..).zip(against_round).filter(|(_, errors)| worse(**errors)).map(|(mip, _)| mip).collect();
    let first = *mips.first()?;
    let [with, without] = against_round[first - 1];
    let numbers = mips.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    Some(format!(
        "--anisotropy surface: mean normals lean, and such engines show highlights around the surface's normal. Mips {numbers} are worse \
         than without it, mip {first} by an error of about {with:.2} instead of {without:.2}; leave it out unless others are seen"
    ))
}

#[cfg(test)]
mod tests {
    use super::warning;

    #[test]
    fn only_mips_that_are_worse_are_named() {
        assert_eq!(warning(&[[0.3, 0.4], [0.2, 0.2], [0.0, 0.0]]), None);
        let said = warning(&[[0.9, 0.25], [0.2, 0.3], [0.5, 0.4]]).unwrap();
        assert!(
            said.contains("Mips 1, 3 are worse") && said.contains("mip 1 by an error of about 0.90 instead of 0.25"),
            "{said}"
        );
    }
}
