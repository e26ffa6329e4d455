//! STL, text and binary.

use std::collections::HashMap;

use crate::prelude::*;

/// Bytes of a binary file: 80 of free text, the 32-bit number of triangles, then per triangle its normal, its
/// three corners and two unused bytes.
const HEADER: usize = 80;
const PREFIX: usize = HEADER + 4;
const TRIANGLE: usize = 50;

/// Checks the length of a binary file against its header, and that any other is text.
pub(super) fn check_start(start: &[u8], size: Option<u64>) -> Result<(), Located> {
    let Some(promised) = promised(start, size)? else {
        return check_is_text(start, "an STL file");
    };
    match size.map(|size| (size - PREFIX as u64) / TRIANGLE as u64) {
        Some(found) if found < promised => Err(Fault::truncated("triangles", promised, found).whole()),
        Some(found) if found > promised => Err(Fault::leftover("triangles", promised).whole()),
        _ if promised == 0 => Err(Fault::no_faces(0).whole()),
        _ => Ok(()),
    }
}

/// The number of triangles that the header of a binary file promises; `None` for text.
///
/// A file that has the length its header promises is binary, whatever it begins with. Any other is binary if a byte of its
/// header is zero: no byte of a text is, and one of every number below 2^24 is.
fn promised(start: &[u8], size: Option<u64>) -> Result<Option<u64>, Located> {
    let Some(&number) = start.get(HEADER..).and_then(<[u8]>::first_chunk) else { return Ok(None) };
    let promised = u64::from(u32::from_le_bytes(number));
    if size == Some(PREFIX as u64 + TRIANGLE as u64 * promised) {
        return Ok(Some(promised));
    }
    check_is_not_utf16(start)?;
    Ok(start[..PREFIX].contains(&0).then_some(promised))
}

/// Reads STL. The format stores three corners per triangle; corners at the same position become one vertex,
/// numbered in the order of first appearance.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    let size = Some(bytes.len() as u64);
    // Of a stream the size was not known.
    check_start(&bytes[..bytes.len().min(PREFIX)], size)?;
    let mut soup = Soup { limits, numbers: HashMap::new(), positions: Vec::new(), corners: Vec::new() };
    match promised(bytes, size)? {
        Some(promised) => parse_binary(bytes, promised, &mut soup)?,
        None => parse_text(bytes, &mut soup)?,
    }
    finish(TriMesh { positions: soup.positions, faces: soup.corners.as_chunks().0.to_vec() }, limits)
}

fn parse_binary(bytes: &[u8], n_triangles: u64, soup: &mut Soup<'_>) -> Result<(), Located> {
    soup.limits.check(0, n_triangles).whole()?;
    for (t, triangle) in bytes[PREFIX..].chunks_exact(TRIANGLE).take(n_triangles as usize).enumerate() {
        // Three numbers each for the normal and the corners.
        for corner in triangle[..48].as_chunks::<4>().0.as_chunks::<3>().0.iter().skip(1) {
            soup.push(corner.map(f32::from_le_bytes)).at_byte(PREFIX + t * TRIANGLE)?;
        }
    }
    Ok(())
}

/// Reads the words of a text, on whichever lines they are.
fn parse_text(bytes: &[u8], soup: &mut Soup<'_>) -> Result<(), Located> {
    let mut words = Words::new(Lines::new(bytes), true);
    // `None` before the first solid.
    let mut is_open = None;
    while let Some(word) = words.next() {
        let line = words.line;
        match &word.to_ascii_lowercase()[..] {
            b"solid" => is_open = Some(true),
            b"endsolid" => is_open = Some(false),
            b"end" if words.begins_with(&["solid"]) => is_open = Some(false),
            b"facet" => {
                is_open = Some(true);
                soup.limits.check(0, soup.corners.len() as u64 / 3 + 1).in_line(line.number)?;
                parse_facet(&mut words, soup)?;
                continue;
            }
            _ if is_open.is_some() => return Err(line.expected("`facet` or `endsolid`")),
            _ => return Err(other_format("an STL file", line.text).whole()),
        }
        // The name of the solid: the rest of the line, or what comes before a facet in it.
        while !words.rest.is_empty() && !words.begins_with(&["facet", "normal"]) {
            words.next();
        }
    }
    match is_open {
        None => Err(Fault::Empty.whole()),
        Some(true) => Err(cut_short(&words)),
        Some(false) => Ok(()),
    }
}

/// Reads what follows `facet`.
fn parse_facet(words: &mut Words<'_>, soup: &mut Soup<'_>) -> Result<(), Located> {
    // `normal` and its three numbers, or some of them.
    let mut skipped = 0;
    while !next_word(words)?.eq_ignore_ascii_case(b"outer") {
        skipped += 1;
        if skipped > 4 {
            return Err(words.line.expected("`outer loop`"));
        }
    }
    expect(words, b"loop", "`outer loop`")?;
    for _ in 0..3 {
        let expected = "`vertex` and three coordinates";
        expect(words, b"vertex", expected)?;
        let mut corner = [0.0; 3];
        for x in &mut corner {
            *x = parse_number(next_word(words)?).ok_or_else(|| words.line.expected(expected))?;
        }
        soup.push(corner).in_line(words.line.number)?;
    }
    expect(words, b"endloop", "`endloop`")?;
    expect(words, b"endfacet", "`endfacet`")
}

fn cut_short(words: &Words<'_>) -> Located {
    Fault::cut_short("`endsolid`").in_line(words.line.number)
}

fn next_word<'a>(words: &mut Words<'a>) -> Result<&'a [u8], Located> {
    words.next().ok_or_else(|| cut_short(words))
}

/// Takes a word in upper or lower case.
fn expect(words: &mut Words<'_>, word: &[u8], expected: &'static str) -> Result<(), Located> {
    match next_word(words)?.eq_ignore_ascii_case(word) {
        true => Ok(()),
        false => Err(words.line.expected(expected)),
    }
}

/// Triangles whose corners are merged by position.
struct Soup<'a> {
    limits: &'a ReadLimits,
    numbers: HashMap<[u32; 3], VertexId>,
    positions: Vec<Point3<f64>>,
    /// The vertices of all corners, three per triangle.
    corners: Vec<VertexId>,
}

impl Soup<'_> {
    /// Adds the next corner. Minus zero equals zero.
    fn push(&mut self, corner: [f32; 3]) -> Result<(), Fault> {
        let p = finite(corner.map(f64::from), self.corners.len())?;
        self.corners.push(*self.numbers.entry(corner.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
            self.positions.push(p);
            VertexId::from(self.positions.len() - 1)
        }));
        self.limits.check(self.positions.len() as u64, 0)
    }
}

/// Writes binary STL. Rounds coordinates to 32 bits; vertex numbers and unused vertices are lost.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh, _: Field<'_>) -> io::Result<()> {
    out.write_all(&[0; HEADER])?;
    out.write_all(&(mesh.n_faces() as u32).to_le_bytes())?;
    for f in 0..mesh.n_faces() {
        let normal = mesh.area_vector(f).try_normalize(0.0).unwrap_or_default();
        let corners = mesh.triangle(f).map(|p| p.coords);
        for x in [normal].iter().chain(&corners).flat_map(|v| v.iter()) {
            out.write_all(&(*x as f32).to_le_bytes())?;
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}
