//! Data compressed by gzip.

use std::io::{self, BufRead, BufReader, Read};

use flate2::bufread::GzDecoder;

/// Decompresses all members of a stream. Zeros behind them are ignored, as `gzip` does: tapes and some copies are filled up.
#[derive(Debug)]
pub struct GzipReader<R> {
    /// `None` after the last one.
    member: Option<GzDecoder<BufReader<R>>>,
}

impl<R: Read> GzipReader<R> {
    /// Begins with the first member.
    pub fn new(stream: R) -> Self {
        Self { member: Some(GzDecoder::new(BufReader::new(stream))) }
    }
}

impl<R: Read> Read for GzipReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while let Some(mut member) = self.member.take() {
            let n = member.read(buffer)?;
            if n > 0 || buffer.is_empty() {
                self.member = Some(member);
                return Ok(n);
            }
            let mut rest = member.into_inner();
            while rest.fill_buf()?.first() == Some(&0) {
                rest.consume(1);
            }
            if !rest.fill_buf()?.is_empty() {
                self.member = Some(GzDecoder::new(rest));
            }
        }
        Ok(0)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn gzip(text: &str) -> Vec<u8> {
        let mut out = GzEncoder::new(Vec::new(), Compression::default());
        out.write_all(text.as_bytes()).unwrap();
        out.finish().unwrap()
    }

    fn gunzip(bytes: &[u8]) -> io::Result<String> {
        let mut text = String::new();
        GzipReader::new(bytes).read_to_string(&mut text).map(|_| text)
    }

    #[test]
    fn members_follow_each_other_and_zeros_the_last() {
        let [a, b, zeros] = [gzip("OFF\n"), gzip("3 1 0\n"), vec![0; 20_000]];
        for (pieces, text) in [
            (vec![&a], "OFF\n"),
            (vec![&a, &b], "OFF\n3 1 0\n"),
            (vec![&a, &zeros], "OFF\n"),
            (vec![&a, &zeros, &b, &zeros], "OFF\n3 1 0\n"),
            (vec![&gzip(""), &a], "OFF\n"),
        ] {
            assert_eq!(gunzip(&pieces.into_iter().flatten().copied().collect::<Vec<_>>()).unwrap(), text);
        }
        for damaged in [&a[..a.len() - 3], &[&a[..], b"garbage"].concat(), b"", &zeros] {
            assert!(gunzip(damaged).is_err(), "{} bytes", damaged.len());
        }
    }
}
