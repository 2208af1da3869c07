//! PNG images in and out. Every fault of a file is one message that names the file and the next thing to try.

use std::io::Cursor;
use std::path::Path;

use depal_frames::Intrinsics;
use png::{BitDepth, ColorType};
use serde::Deserialize;

use crate::failure::{Failure, cannot_read};
use crate::false_colour::{Indexed, palette};

/// More pixels than any depth camera has; keeps a wrong header from asking for all memory.
const MOST_PIXELS: usize = 1 << 26;

/// What an `intrinsics.json` says.
pub fn read_intrinsics(path: &Path) -> Result<Intrinsics, Failure> {
    parse_intrinsics(&read(path)?).map_err(|reason| input(path, &reason))
}

/// Depth in steps of `scale` metres, row by row; 0 = invalid.
pub fn read_depth(path: &Path, intrinsics: &Intrinsics, scale: f64) -> Result<Vec<f32>, Failure> {
    decode_depth(&read(path)?, intrinsics, scale).map_err(|reason| input(path, &reason))
}

/// Grey values, row by row.
pub fn read_grey(path: &Path, intrinsics: &Intrinsics) -> Result<Vec<u8>, Failure> {
    decode(&read(path)?, intrinsics, BitDepth::Eight, "intensity").map_err(|r| input(path, &r))
}

/// Writes a whole file.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    std::fs::write(path, bytes)
        .map_err(|error| Failure::Environment(format!("cannot write {}: {error}", path.display())))
}

/// A 16-bit grey PNG of depth (metres) in steps of 0.1 mm; what does not fit in is 0.
pub fn depth_png(intrinsics: &Intrinsics, depth: &[f32]) -> Result<Vec<u8>, Failure> {
    let bytes: Vec<u8> = depth
        .iter()
        .flat_map(|&z| {
            let steps = (f64::from(z) * 1e4).round();
            let value = if (0.0..=65535.0).contains(&steps) {
                steps as u16
            } else {
                0
            };
            value.to_be_bytes()
        })
        .collect();
    encode(intrinsics, ColorType::Grayscale, BitDepth::Sixteen, &bytes)
}

/// An 8-bit grey PNG.
pub fn grey_png(intrinsics: &Intrinsics, grey: &[u8]) -> Result<Vec<u8>, Failure> {
    encode(intrinsics, ColorType::Grayscale, BitDepth::Eight, grey)
}

/// An 8-bit colour PNG from red, green, blue per pixel.
pub fn colour_png(intrinsics: &Intrinsics, pixels: &[[u8; 3]]) -> Result<Vec<u8>, Failure> {
    let bytes = pixels.as_flattened();
    encode(intrinsics, ColorType::Rgb, BitDepth::Eight, bytes)
}

/// An 8-bit PNG with the colours of depth.
pub fn false_colour_png(picture: &Indexed) -> Result<Vec<u8>, Failure> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, picture.width as u32, picture.height as u32);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette());
    encoder.set_compression(png::Compression::High);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&picture.pixels))
        .map_err(|error| Failure::Environment(format!("cannot encode a PNG: {error}")))?;
    Ok(file)
}

fn encode(
    intrinsics: &Intrinsics,
    colour: ColorType,
    depth: BitDepth,
    bytes: &[u8],
) -> Result<Vec<u8>, Failure> {
    let mut file = Vec::new();
    let (width, height) = (intrinsics.width as u32, intrinsics.height as u32);
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(bytes))
        .map_err(|error| Failure::Environment(format!("cannot encode a PNG: {error}")))?;
    Ok(file)
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| {
        let cannot = cannot_read(path, error);
        Failure::Input(format!(
            "{cannot}\nhelp: depal render --out DIR makes such files to try with"
        ))
    })
}

fn input(path: &Path, reason: &str) -> Failure {
    Failure::Input(format!("{}: {reason}", path.display()))
}

/// The file's keys as they come: other programs write whole numbers as 1280.0.
#[derive(Deserialize)]
struct IntrinsicsFile {
    width: f64,
    height: f64,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
}

fn parse_intrinsics(bytes: &[u8]) -> Result<Intrinsics, String> {
    let file: IntrinsicsFile = serde_json::from_slice(bytes).map_err(|error| {
        format!(
            "{error}\nhelp: expected {{\"width\":1280,\"height\":1024,\"fx\":1216.0,\"fy\":1216.0,\"cx\":639.5,\"cy\":511.5}}, in pixels"
        )
    })?;
    let side = |name: &str, value: f64| {
        if value.fract() == 0.0 && (1.0..=16384.0).contains(&value) {
            Ok(value as usize)
        } else {
            Err(format!(
                "{name}: expected a whole number of 1 to 16384 pixels, found {value}"
            ))
        }
    };
    let intrinsics = Intrinsics {
        width: side("width", file.width)?,
        height: side("height", file.height)?,
        fx: file.fx,
        fy: file.fy,
        cx: file.cx,
        cy: file.cy,
    };
    let i = &intrinsics;
    if i.width * i.height > MOST_PIXELS {
        return Err(format!(
            "expected at most {MOST_PIXELS} pixels, found {} x {}",
            i.width, i.height
        ));
    }
    for (name, value, size) in [("fx", i.fx, i.width), ("fy", i.fy, i.height)] {
        // From a field of view of 170 degrees to one of half a degree over 1000 pixels.
        let (low, high) = (0.04 * size.min(1000) as f64, 1e5);
        if !(low..=high).contains(&value) {
            return Err(format!(
                "{name}: expected {low} to {high} pixels, found {value:?}; is it in millimetres?"
            ));
        }
    }
    for (name, value, size) in [("cx", i.cx, i.width), ("cy", i.cy, i.height)] {
        let size = size as f64;
        if !(-size..=2.0 * size).contains(&value) {
            return Err(format!(
                "{name}: expected about the middle of {size} pixels, found {value:?}"
            ));
        }
    }
    Ok(intrinsics)
}

fn decode_depth(bytes: &[u8], intrinsics: &Intrinsics, scale: f64) -> Result<Vec<f32>, String> {
    Ok(decode(bytes, intrinsics, BitDepth::Sixteen, "depth")?
        .chunks_exact(2)
        .map(|pair| (f64::from(u16::from_be_bytes([pair[0], pair[1]])) * scale) as f32)
        .collect())
}

/// Bytes of a grey image of exactly the size and depth that is expected.
fn decode(
    bytes: &[u8],
    intrinsics: &Intrinsics,
    depth: BitDepth,
    what: &str,
) -> Result<Vec<u8>, String> {
    let broken = |error: png::DecodingError| {
        format!("not a whole PNG image: {error}\nhelp: was it copied whole, and is it a PNG?")
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_limits(png::Limits {
        bytes: 4 * MOST_PIXELS,
    });
    let mut reader = decoder.read_info().map_err(broken)?;
    let info = reader.info();
    if info.color_type != ColorType::Grayscale || info.bit_depth != depth {
        return Err(format!(
            "expected the {what} image in {} bit grey, found {} bit {}\nhelp: {}",
            depth as u8,
            info.bit_depth as u8,
            colour_name(info.color_type),
            match depth {
                BitDepth::Sixteen => "save depth as whole steps of --depth-scale-mm; 0 = invalid",
                _ => "save it as a grey image of the same size, or leave it out",
            }
        ));
    }
    let found = (info.width as usize, info.height as usize);
    if found != (intrinsics.width, intrinsics.height) {
        return Err(format!(
            "expected {} x {} pixels as the intrinsics say, found {} x {}\n\
             help: give the intrinsics of this image; half the size has half of fx, fy, cx and cy",
            intrinsics.width, intrinsics.height, found.0, found.1
        ));
    }
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| "the image is too large".to_owned())?;
    let mut pixels = vec![0; size];
    reader.next_frame(&mut pixels).map_err(broken)?;
    reader.finish().map_err(broken)?;
    Ok(pixels)
}

fn colour_name(colour: ColorType) -> &'static str {
    match colour {
        ColorType::Grayscale => "grey",
        ColorType::GrayscaleAlpha => "grey with transparency",
        ColorType::Rgb => "colour",
        ColorType::Rgba => "colour with transparency",
        ColorType::Indexed => "indexed colour",
    }
}

#[cfg(test)]
mod tests;
