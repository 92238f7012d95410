//! Is the green axis up or down? A surface has no curl, and a flipped axis breaks that.
//!
//! Over a height field with y up, ∂m_x/∂y = ∂m_y/∂x: the two cross derivatives are equal, their correlation is +1.
//! With green flipped it is −1. Projected normals stand in for slopes: they behave alike and have no poles at the
//! horizon. Real maps give 0.4 to 0.95 in size; flat and flake maps next to nothing, for those are no height fields.

use super::NormalMap;

/// Correlation below which green is called flipped. Real DirectX maps lie at −0.4 and lower.
const FLIPPED_BELOW: f64 = -0.3;

/// Texels below which nothing is concluded: few texels hold few independent ones.
const ENOUGH_TEXELS: u64 = 4096;

/// Correlation, over the interior texels, of ∂s_x/∂y with ∂s_y/∂x by central differences (y = −v). None when there are
/// no interior texels or a derivative does not vary.
pub(super) fn curl_correlation(map: &NormalMap) -> Option<f64> {
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for j in 1..map.height as i64 - 1 {
        for i in 1..map.width as i64 - 1 {
            // The common factor ½ of the differences cancels.
            let a = map.texel(i, j - 1).x - map.texel(i, j + 1).x;
            let b = map.texel(i + 1, j).y - map.texel(i - 1, j).y;
            aa += a * a;
            bb += b * b;
            ab += a * b;
        }
    }
    let scale = (aa * bb).sqrt();
    (scale > 0.0).then(|| ab / scale)
}

/// True when the correlation says so and there is enough to go by.
pub(super) fn flipped_green(map: &NormalMap, curl_correlation: Option<f64>) -> bool {
    let enough = map.width as u64 * map.height as u64 >= ENOUGH_TEXELS;
    enough && curl_correlation.is_some_and(|c| c < FLIPPED_BELOW)
}
