//! Scanlines of a Radiance file, one after the other, in each of their three forms.
//!
//! - Run lengths of components: 2, 2 and the length in two bytes, then red, green, blue and exponent of the whole scanline, each
//!   as runs (128 + count, value) and plain bytes (count, values). Scanlines of 8 to 32767 pixels have them, and one that
//!   begins with 2, 2 and a byte below 128 is no pixel: Radiance writes none whose mantissas are all that small.
//! - Flat: four bytes a pixel.
//! - Old run lengths, among flat pixels: 1, 1, 1, n repeats the pixel before n times, and one more such right after it
//!   counts by 256, and so on.

/// Lengths of scanlines that may be stored by component.
const BY_COMPONENT: std::ops::RangeInclusive<usize> = 8..=32767;
/// Old runs of more bytes than this are longer than any image.
const MAX_SHIFT: u32 = 24;

/// Why a scanline cannot be read.
#[derive(Debug, PartialEq, Eq)]
pub enum Fault {
    /// The data ends before it does.
    CutOff,
    /// What stands there makes no sense.
    Damaged {
        /// Where, in bytes from the first scanline.
        at: usize,
        /// What was expected and found.
        what: String,
    },
}

/// Scanlines that are still to come.
pub struct Scanlines<'a> {
    data: &'a [u8],
    at: usize,
}

impl<'a> Scanlines<'a> {
    /// All scanlines of `data`.
    pub fn new(data: &'a [u8]) -> Scanlines<'a> {
        Scanlines { data, at: 0 }
    }

    /// What follows the scanlines that were read.
    pub fn rest(&self) -> &'a [u8] {
        &self.data[self.at..]
    }

    /// Reads the next scanline: mantissas and exponent of each pixel.
    pub fn next(&mut self, line: &mut [[u8; 4]]) -> Result<(), Fault> {
        let found = match self.rest() {
            [2, 2, high, low, ..] if *high < 128 && BY_COMPONENT.contains(&line.len()) => {
                usize::from(*high) << 8 | usize::from(*low)
            }
            _ => return self.flat(line),
        };
        if found != line.len() {
            let what = format!("expected a scanline of {} pixels, found one of {found}", line.len());
            return Err(Fault::Damaged { at: self.at, what });
        }
        self.at += 4;
        (0..4).try_for_each(|component| self.component(line, component))
    }

    /// One component of a scanline.
    fn component(&mut self, line: &mut [[u8; 4]], component: usize) -> Result<(), Fault> {
        let mut done = 0;
        while done < line.len() {
            let at = self.at;
            let [code] = self.take()?;
            let run = code > 128;
            let count = usize::from(if run { code - 128 } else { code });
            if count > line.len() - done {
                let what = format!("expected at most {} more values of a scanline, found {count}", line.len() - done);
                return Err(Fault::Damaged { at, what });
            }
            let pixels = &mut line[done..done + count];
            if run {
                let [value] = self.take()?;
                pixels.iter_mut().for_each(|pixel| pixel[component] = value);
            } else {
                let values = self.data.get(self.at..self.at + count).ok_or(Fault::CutOff)?;
                pixels.iter_mut().zip(values).for_each(|(pixel, value)| pixel[component] = *value);
                self.at += count;
            }
            done += count;
        }
        Ok(())
    }

    /// A scanline of whole pixels and old runs.
    fn flat(&mut self, line: &mut [[u8; 4]]) -> Result<(), Fault> {
        let (mut done, mut shift) = (0, 0);
        while done < line.len() {
            let at = self.at;
            let pixel = self.take()?;
            let [1, 1, 1, count] = pixel else {
                line[done] = pixel;
                (done, shift) = (done + 1, 0);
                continue;
            };
            let count = if shift <= MAX_SHIFT { usize::from(count) << shift } else { usize::MAX };
            if done == 0 || count > line.len() - done {
                let what = if done == 0 {
                    "expected a pixel, found a run of the one before, and there is none in this scanline".to_owned()
                } else {
                    format!("expected at most {} more pixels of a scanline, found a longer run", line.len() - done)
                };
                return Err(Fault::Damaged { at, what });
            }
            let before = line[done - 1];
            line[done..done + count].fill(before);
            (done, shift) = (done + count, shift + 8);
        }
        Ok(())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let bytes = self.rest().first_chunk().ok_or(Fault::CutOff)?;
        self.at += N;
        Ok(*bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [u8; 4] = [200, 100, 50, 130];
    const B: [u8; 4] = [3, 4, 250, 127];

    fn read(data: &[u8], length: usize) -> Result<Vec<[u8; 4]>, Fault> {
        let mut line = vec![[0; 4]; length];
        let mut scanlines = Scanlines::new(data);
        scanlines.next(&mut line)?;
        assert!(scanlines.rest().is_empty());
        Ok(line)
    }

    /// A scanline of one colour by component.
    fn by_component(length: usize, pixel: [u8; 4]) -> Vec<u8> {
        let mut data = vec![2, 2, (length >> 8) as u8, length as u8];
        for value in pixel {
            let mut left = length;
            while left > 0 {
                let count = left.min(127);
                data.extend([128 + count as u8, value]);
                left -= count;
            }
        }
        data
    }

    #[test]
    fn every_form_is_read() {
        let runs = [&A[..], &[1, 1, 1, 2], &B, &[1, 1, 1, 1]].concat();
        assert_eq!(read(&runs, 5), Ok(vec![A, A, A, B, B]));
        // 3 and then 2 · 256 more.
        let long = [&A[..], &[1, 1, 1, 3], &[1, 1, 1, 2], &B].concat();
        let mut expected = vec![A; 1 + 3 + 512];
        expected.push(B);
        assert_eq!(read(&long, expected.len()), Ok(expected));
        assert_eq!(read(&by_component(300, A), 300), Ok(vec![A; 300]));
        let mixed =
            [&[2, 2, 0, 9][..], &[2, 7, 8, 128 + 7, 9], &[128 + 9, 5], &[9, 1, 2, 3, 4, 5, 6, 7, 8, 9], &[137, 128]];
        let line = read(&mixed.concat(), 9).unwrap();
        assert_eq!((line[0], line[1], line[8]), ([7, 5, 1, 128], [8, 5, 2, 128], [9, 5, 9, 128]));
    }

    /// Scanlines that are too short or too long for components are flat whatever they begin with, and so is 2, 2, 128.
    #[test]
    fn pixels_that_look_like_a_length_are_pixels() {
        let small = [2, 2, 0, 7];
        assert_eq!(read(&[small; 7].concat(), 7), Ok(vec![small; 7]));
        let wide = [2, 2, 127, 255];
        assert_eq!(read(&[wide; 32768].concat(), 32768), Ok(vec![wide; 32768]));
        let bright = [2, 2, 128, 9];
        assert_eq!(read(&[bright; 9].concat(), 9), Ok(vec![bright; 9]));
    }

    #[test]
    fn damage_is_placed() {
        let at = |data: &[u8], length| match read(data, length) {
            Err(Fault::Damaged { at, .. }) => Some(at),
            _ => None,
        };
        assert_eq!(at(&by_component(300, A), 200), Some(0));
        assert_eq!(at(&[[1, 1, 1, 4], A].concat(), 5), Some(0));
        assert_eq!(at(&[A, [1, 1, 1, 5]].concat(), 5), Some(4));
        assert_eq!(at(&[A, [1, 1, 1, 0], [1, 1, 1, 1]].concat(), 5), Some(8));
        assert_eq!(
            at(&[A, [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0]].concat(), 5),
            Some(20)
        );
        assert_eq!(at(&[&[2, 2, 0, 9, 137, 1, 8][..], &[0; 8], &[130, 3]].concat(), 9), Some(15));
    }

    #[test]
    fn every_shorter_file_is_cut_off() {
        for (whole, length) in [(by_component(300, A), 300), ([A, B, [1, 1, 1, 4]].concat(), 6)] {
            for end in 0..whole.len() {
                assert_eq!(read(&whole[..end], length), Err(Fault::CutOff), "{end}");
            }
        }
    }
}
