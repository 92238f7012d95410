//! Numbers as people read them.

/// Bytes as KiB with separators: `5,440 KiB`.
pub fn kib(bytes: u64) -> String {
    let kib = bytes as f64 / 1024.0;
    if kib < 100.0 {
        return format!("{kib:.1} KiB");
    }
    let digits = format!("{kib:.0}");
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            out.push(',');
        }
        out.push(digit);
    }
    out + " KiB"
}

/// A share as per cent with three significant digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = match percent {
        p if p >= 10.0 => 1,
        p if p >= 1.0 => 2,
        _ => 3,
    };
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_shares_read_well() {
        assert_eq!(kib(1536), "1.5 KiB");
        assert_eq!(kib(5440 << 10), "5,440 KiB");
        assert_eq!(kib(1_234_567 << 10), "1,234,567 KiB");
        assert_eq!(percent(0.00523), "0.523 %");
        assert_eq!(percent(0.12), "12.0 %");
    }
}
