//! Not committed.
use depal_frames::{BoxSize, DepthFrame, Intrinsics};
use depal_vision::{VisionSettings, detect};
fn main() {
    for dir in std::env::args().skip(1) {
        let text = std::fs::read_to_string(format!("{dir}/frame.txt")).unwrap();
        let n: Vec<f64> = text.split_whitespace().map(|t| t.parse().unwrap()).collect();
        let intrinsics = Intrinsics { width: n[0] as usize, height: n[1] as usize, fx: n[2], fy: n[3], cx: n[4], cy: n[5] };
        let raw = std::fs::read(format!("{dir}/depth.raw")).unwrap();
        let depth = raw.chunks_exact(2).map(|b| f32::from(u16::from_le_bytes([b[0], b[1]])) * 1e-3).collect();
        let frame = DepthFrame { intrinsics, depth, intensity: Vec::new() };
        let size = BoxSize::from_mm([n[6], n[7], n[8]]);
        let started = std::time::Instant::now();
        let settings = VisionSettings::new(vec![size]).suited_to(&frame);
        let d = detect(&frame, &settings);
        println!("dir {dir} ms {:.0} smear {} average {} step {:.1} tol {:.1} size {:.1}", started.elapsed().as_secs_f64()*1e3, settings.smear_px, settings.average_px, settings.step * 1e3, settings.plane_tolerance*1e3, settings.size_tolerance*1e3);
        for b in &d.boxes {
            let t = b.camera_from_box.translation.vector * 1e3;
            let q = b.camera_from_box.rotation;
            println!("box {} {} {} {} {} {} {} {} {} {}", t.x, t.y, t.z, q.w, q.i, q.j, q.k, b.confidence, b.proven_sides, b.size.length*1e3);
        }
        for r in d.rejected.iter().filter(|r| r.area > 0.02) {
            println!("rej {:?} {:.3} at {:.0} {:.0} {:.0}", r.reason, r.area, r.centre_in_camera.x*1e3, r.centre_in_camera.y*1e3, r.centre_in_camera.z*1e3);
        }
    }
}
