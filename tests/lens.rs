//! Lenses: against an independent exact trace, and by the laws of optics.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use glam::{DMat2, DVec2, DVec3};
use rilievo::camera::lens::{BUILT_IN, D_LINE_UM, Layer, Lens, built_in, open, reflectance, to_toml};
use rilievo::camera::{
    Ghost, Paraxial, Tracer, beam_direction, ghosts, refraction, refraction_backward, single_crossing_ghosts,
};
use serde_json::Value;

fn lens(name: &str) -> Lens {
    built_in(name).expect("a built-in lens").expect("a sound table")
}

/// A lens of `tests/fixtures/lenses`.
fn fixture(name: &str) -> Lens {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/lenses");
    open(folder.join(name).with_extension("toml").to_str().unwrap()).unwrap()
}

fn shared_lenses() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/lenses");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!(
        "SKIPPED: {} is absent, nothing was compared with the exact trace",
        folder.display()
    );
    None
}

/// Counts of Lee & Eisemann 2013 (Table 2) and of combinatorics: pairs on one side of the stop.
#[test]
fn ghosts_that_cross_the_stop_once() {
    for (name, single) in [
        ("heliar", 13),
        ("angenieux", 42),
        ("itoh", 73),
        ("nikon", 142),
        ("canon", 312),
    ] {
        assert_eq!(single_crossing_ghosts(&lens(name)).len(), single, "{name}");
    }
}

/// The paper's Heliar by an independent calculation; Example 1 of U.S. 2,645,156 likewise.
#[test]
fn focal_lengths() {
    for (name, efl, bfd) in [
        ("heliar", 99.235_796_349_124_39, 81.315_056_421_726_34),
        ("heliar-example-1", 100.019_029, 82.045_722),
    ] {
        let paraxial = Paraxial::new(&lens(name), D_LINE_UM, None);
        assert!(
            (paraxial.efl_mm / efl - 1.0).abs() < 1e-8,
            "{name}: {}",
            paraxial.efl_mm
        );
        assert!(
            (paraxial.bfd_mm / bfd - 1.0).abs() < 1e-8,
            "{name}: {}",
            paraxial.bfd_mm
        );
    }
}

fn matrix_of(value: &Value) -> DMat2 {
    let at = |row: usize, column: usize| value[row][column].as_f64().unwrap();
    DMat2::from_cols(DVec2::new(at(0, 0), at(1, 0)), DVec2::new(at(0, 1), at(1, 1)))
}

fn point_of(value: &Value) -> DVec2 {
    DVec2::new(value[0].as_f64().unwrap(), value[1].as_f64().unwrap())
}

#[test]
fn every_ray_of_the_independent_trace_of_the_heliar() {
    let Some(folder) = shared_lenses() else { return };
    let truth: Value =
        serde_json::from_slice(&std::fs::read(folder.join("heliar_ghosts.json")).unwrap()).unwrap();
    let heliar = lens("heliar");
    let gap = heliar.surfaces[8].thickness_mm;
    let tracer = Tracer::new(&heliar, D_LINE_UM, gap);
    let paraxial = Paraxial::new(&heliar, D_LINE_UM, Some(gap));
    let (mut rays, mut worst, mut worst_matrix) = (0, 0.0_f64, 0.0_f64);
    for case in truth["cases"].as_array().unwrap() {
        let [i, j] = [0, 1].map(|k| case["ghost"][k].as_u64().unwrap() as usize);
        let ghost = (i > 0).then(|| Ghost {
            first: i - 1,
            second: j - 1,
        });
        let matrices = paraxial.matrices(ghost);
        for (key, ours) in [("Ma", matrices.ma), ("Ms", matrices.ms), ("Mf", matrices.mf)] {
            let theirs = matrix_of(&case[key]);
            let scale = theirs.x_axis.length() + theirs.y_axis.length();
            worst_matrix = worst_matrix.max(
                (ours - theirs)
                    .x_axis
                    .length()
                    .max((ours - theirs).y_axis.length())
                    / scale,
            );
        }
        let direction = beam_direction(case["theta_deg"].as_f64().unwrap().to_radians());
        for ray in case["rays"].as_array().unwrap() {
            let traced = tracer.trace(ghost, point_of(&ray["entry"]), direction).unwrap();
            let off = (traced.stop_mm - point_of(&ray["stop"]))
                .length()
                .max((traced.sensor_mm - point_of(&ray["sensor"])).length());
            worst = worst.max(off);
            assert!((traced.relative_height - ray["rel"].as_f64().unwrap()).abs() < 1e-9);
            rays += 1;
        }
    }
    println!("{rays} rays within {worst:.1e} mm, matrices within {worst_matrix:.1e}");
    assert!(rays > 1000);
    assert!(worst < 1e-9, "{worst} mm off");
    assert!(worst_matrix < 1e-12);
}

/// Rays of `tools/make_lens_fixture.py`, an implementation of its own in 50 digits: spherical and strongly aspheric lenses, the
/// image and ghosts; the power where no surface is coated.
#[test]
fn every_ray_of_the_committed_independent_trace() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/lens");
    let truth: Value = serde_json::from_slice(&std::fs::read(folder.join("rays.json")).unwrap()).unwrap();
    let (mut rays, mut ghost_rays, mut powers) = (0, 0, 0);
    let (mut worst_mm, mut worst_power) = (0.0_f64, 0.0_f64);
    for table in truth["lenses"].as_array().unwrap() {
        let name = table["lens"].as_str().unwrap();
        let lens = match built_in(name) {
            Some(lens) => lens.unwrap(),
            None => open(&folder.join(format!("{name}.toml")).display().to_string()).unwrap(),
        };
        let tracer = Tracer::new(&lens, D_LINE_UM, table["sensor_gap_mm"].as_f64().unwrap());
        for row in table["rays"].as_array().unwrap() {
            let row: Vec<f64> = row
                .as_array()
                .unwrap()
                .iter()
                .map(|v| v.as_f64().unwrap())
                .collect();
            let ghost = (row[0] > 0.0).then(|| Ghost {
                first: row[0] as usize - 1,
                second: row[1] as usize - 1,
            });
            let point = |k: usize| DVec2::new(row[k], row[k + 1]);
            let direction = point(4).extend(1.0).normalize();
            let traced = tracer.trace(ghost, point(2), direction).unwrap();
            let off_mm = traced
                .stop_mm
                .distance(point(6))
                .max(traced.sensor_mm.distance(point(8)));
            worst_mm = worst_mm.max(off_mm);
            assert!(
                (traced.relative_height - row[10]).abs() < 1e-9,
                "{name} {ghost:?}"
            );
            if let Some(power) = row.get(11) {
                worst_power = worst_power.max((traced.power / power - 1.0).abs());
                powers += 1;
            }
            rays += 1;
            ghost_rays += usize::from(ghost.is_some());
        }
    }
    println!("{rays} rays within {worst_mm:.1e} mm, {powers} powers within {worst_power:.1e}");
    assert!(rays > 300 && ghost_rays > 250 && powers > 100);
    assert!(worst_mm < 1e-9, "{worst_mm} mm off");
    assert!(worst_power < 1e-9, "{worst_power} of the power off");
}

/// Every matrix is the exact tracer's derivative on the axis.
#[test]
fn matrices_are_the_derivative_of_the_exact_trace() {
    for (name, _) in BUILT_IN {
        let lens = lens(name);
        let paraxial = Paraxial::new(&lens, D_LINE_UM, None);
        let tracer = Tracer::new(&lens, D_LINE_UM, paraxial.sensor_gap_mm());
        for ghost in single_crossing_ghosts(&lens) {
            let matrices = paraxial.matrices(Some(ghost));
            // Third-order terms fall out of the central difference of two steps (Richardson).
            let derivative = |trace: &dyn Fn(f64) -> [f64; 2], h: f64| {
                let central = |h: f64| {
                    let (ahead, behind) = (trace(h), trace(-h));
                    [0, 1].map(|k| (ahead[k] - behind[k]) / (2.0 * h))
                };
                let (coarse, fine) = (central(h), central(0.5 * h));
                [0, 1].map(|k| (4.0 * fine[k] - coarse[k]) / 3.0)
            };
            let both = |ray: rilievo::camera::TracedRay| [ray.stop_mm.x, ray.sensor_mm.x];
            let by_height = derivative(
                &|x| both(tracer.trace(Some(ghost), DVec2::new(x, 0.0), DVec3::Z).unwrap()),
                2e-3,
            );
            let by_slope = derivative(
                &|u: f64| {
                    let direction = DVec3::new(u, 0.0, 1.0).normalize();
                    both(tracer.trace(Some(ghost), DVec2::ZERO, direction).unwrap())
                },
                1e-4,
            );
            let expected = [
                [matrices.ma.x_axis.x, matrices.ma.y_axis.x],
                [matrices.mf.x_axis.x, matrices.mf.y_axis.x],
            ];
            for k in 0..2 {
                let scale = [expected[k][0].abs().max(0.01), expected[k][1].abs().max(1.0)];
                let off = [by_height[k] - expected[k][0], by_slope[k] - expected[k][1]];
                assert!(
                    off[0].abs() < 1e-6 * scale[0] && off[1].abs() < 1e-6 * scale[1],
                    "{name} {ghost:?}: {off:?} of {expected:?}"
                );
            }
        }
    }
}

/// Regression: the literal inverse for refraction from behind puts the Heliar's ghost (9, 7) 1.2 mm off at 5 degrees.
#[test]
fn the_literal_inverse_is_the_wrong_sign() {
    let (n1, n2, curvature) = (1.0, 1.652, 1.0 / 30.81);
    let right = refraction_backward(n1, n2, curvature);
    let literal = refraction(n1, n2, curvature).inverse();
    assert!(
        (right.x_axis.y + literal.x_axis.y).abs() < 1e-15,
        "the power changes its sign"
    );
    let heliar = lens("heliar");
    let gap = heliar.surfaces[8].thickness_mm;
    let ghost = Ghost { first: 8, second: 6 };
    let exact = Tracer::new(&heliar, D_LINE_UM, gap)
        .trace(Some(ghost), DVec2::ZERO, beam_direction(5_f64.to_radians()))
        .unwrap();
    let slope = 5_f64.to_radians().tan();
    let at = Paraxial::new(&heliar, D_LINE_UM, Some(gap))
        .matrices(Some(ghost))
        .mf
        * DVec2::new(0.0, slope);
    assert!(
        (at.x - exact.sensor_mm.x).abs() < 0.1,
        "{} and {}",
        at.x,
        exact.sensor_mm.x
    );
}

/// A biconvex singlet, radii 50 and -60 mm, 6 mm thick, in a file of its own; its focal length, or the refusal.
fn singlet(ending: &str, text: &str) -> Result<f64, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("singlet.{ending}"));
    std::fs::write(&path, text).unwrap();
    let lens = open(&path.display().to_string()).map_err(|error| error.to_string())?;
    Ok(Paraxial::new(&lens, D_LINE_UM, None).efl_mm)
}

/// Focal lengths by rayoptics 0.9.8 with opticalglass 1.1.1, those in F2 by the thick lens equation. A Zemax file states 1.5 and 40 for a glass that it leaves to its
/// catalogue; CODE V changes surfaces after their rows.
#[test]
fn glasses_and_edits_as_the_formats_have_them() {
    let zemax = |glass: &str, gcat: &str| {
        let text = format!(
            "UNIT MM\nGCAT {gcat}\nSURF 0\n TYPE STANDARD\n DISZ INFINITY\nSURF 1\n STOP\n TYPE STANDARD\n CURV 0.02\n DISZ 6\n \
             GLAS {glass}\nSURF 2\n TYPE STANDARD\n CURV -0.016666666666666666\n DISZ 47\nSURF 3\n TYPE STANDARD\n"
        );
        singlet("zmx", &text)
    };
    let codev = |rows: &str| singlet("seq", &format!("RDM;LEN\nDIM M\nSO 0 1e13\n{rows}\nSI 0 0\nGO\n"));
    for (found, expected) in [
        (zemax("S-LAH66 0 0 1.5 40", "SCHOTT OHARA"), 36.164),
        (zemax("620603 0 0 1.5 40", "SCHOTT"), 44.926),
        (zemax("F2 0 0 1.5 40", "CDGM"), 45.438),
        (zemax("F2 0 0 1.5 40", "SCHOTT"), 44.923),
        (zemax("___BLANK 1 0 1,62 60,3", "SCHOTT"), 44.926),
        (codev("S 50 6 NBK7_SCHOTT\nSTO\nS -60 47"), 53.772),
        (codev("S 50 6 'NBK7_SCHOTT' & ! on\n\nSTO\nS -60 47"), 53.772),
        (codev("S 50 6 NBK7_SCHOTT\nSTO\nTHI 9\nS -60 47"), 54.286),
        (codev("S 50 6 NBK7_SCHOTT\nSTO\nS -60 47\nTHI S1 9"), 54.286),
        (codev("S 50 6 NBK7_SCHOTT\nSTO\nRDY 40\nS -60 47"), 47.409),
        (codev("S 50 6 F2_CDGM\nSTO\nS -60 47"), 45.438),
    ] {
        let efl = found.unwrap();
        assert!((efl - expected).abs() < 6e-4, "{efl} and {expected}");
    }
    for (refusal, word) in [
        (zemax("E48R 0 0 1.5 40", "MISC"), "E48R"),
        (codev("S 50 6 NBK7_SCHOTT\nADE 1\nSTO\nS -60 47"), "ADE"),
        (codev("S -120 5 NBK7_SCHOTT REFL\nSTO\nS -60 47"), "mirrors"),
        (codev("S 50 6 NBK7_NOBODY\nSTO\nS -60 47"), "NBK7_NOBODY"),
    ] {
        let message = refusal.unwrap_err();
        assert!(
            message.contains("singlet.") && message.contains(word),
            "{message}"
        );
    }
}

/// Figures of the Python package tmm 0.2.0 (Byrnes, coherent transfer matrices), mean of both polarisations: index before, films
/// (index, nanometres), index behind, degrees, micrometres, reflectance.
#[test]
fn reflectance_agrees_with_an_independent_transfer_matrix() {
    type Row<'a> = (f64, &'a [(f64, f64)], f64, f64, f64, f64);
    let rows: [Row<'_>; 8] = [
        (1.0, &[(1.38, 99.6)], 1.5168, 30.0, 0.55, 0.014063335516),
        (1.0, &[(1.38, 99.6)], 1.62, 0.0, 0.65, 0.009497616829),
        (1.62, &[(1.38, 99.6)], 1.0, 25.0, 0.475, 0.010751800335),
        (
            1.0,
            &[(1.38, 95.0), (2.1, 130.0), (1.65, 80.0)],
            1.5168,
            45.0,
            0.51,
            0.009852038308,
        ),
        (
            1.7847,
            &[(1.65, 80.0), (2.1, 130.0), (1.38, 95.0)],
            1.0,
            20.0,
            0.6,
            0.001776641234,
        ),
        (
            1.0,
            &[(1.46, 94.0), (2.35, 58.5)],
            1.5168,
            60.0,
            0.48,
            0.079886569275,
        ),
        // Total reflection that a thin film lets through, and that none does.
        (1.5168, &[(1.2, 3.0)], 1.0, 40.0, 0.55, 0.305892698091),
        (1.5168, &[(1.38, 120.0)], 1.0, 50.0, 0.55, 1.0),
    ];
    for (before, films, behind, degrees, wavelength_um, expected) in rows {
        let films: Vec<Layer> = films
            .iter()
            .map(|&(index, nm)| Layer {
                index,
                thickness_um: nm * 1e-3,
            })
            .collect();
        let share = reflectance(
            before,
            &films,
            behind,
            f64::to_radians(degrees).cos(),
            wavelength_um,
        );
        assert!(
            (share - expected).abs() < 1e-9,
            "{films:?}: {share} and {expected}"
        );
    }
}

/// Fresnel at normal incidence; a quarter wave's closed form; Brewster's angle; nothing lost at equal indices.
#[test]
fn reflectance_obeys_the_closed_forms() {
    let bare = reflectance(1.0, &[], 1.5, 1.0, 0.55);
    assert!((bare - 0.04).abs() < 1e-12);
    let (n0, n1, ns) = (1.0, 1.38, 1.652);
    let film = [Layer {
        index: n1,
        thickness_um: 0.55 / (4.0 * n1),
    }];
    let quarter = ((n0 * ns - n1 * n1) / (n0 * ns + n1 * n1)).powi(2);
    assert!((reflectance(n0, &film, ns, 1.0, 0.55) - quarter).abs() < 1e-12);
    // Half a wave is as if it were absent.
    let half = [Layer {
        index: n1,
        thickness_um: 0.55 / (2.0 * n1),
    }];
    let none = reflectance(n0, &[], ns, 1.0, 0.55);
    assert!((reflectance(n0, &half, ns, 1.0, 0.55) - none).abs() < 1e-12);
    // At Brewster's angle only the s polarisation is reflected, (n²-1)²/(n²+1)² of it.
    let cos = 1.0 / (1.0 + 1.5_f64.powi(2)).sqrt();
    let s_only = ((1.5_f64.powi(2) - 1.0) / (1.5_f64.powi(2) + 1.0)).powi(2) / 2.0;
    assert!((reflectance(1.0, &[], 1.5, cos, 0.55) - s_only).abs() < 1e-12);
    // Reversible: the same share from either side, with the films in the order that the light meets them.
    let stack = [
        Layer {
            index: 1.38,
            thickness_um: 0.09,
        },
        Layer {
            index: 2.1,
            thickness_um: 0.05,
        },
    ];
    let back: Vec<Layer> = stack.iter().rev().copied().collect();
    let cos_in: f64 = 0.8;
    let cos_out = (1.0 - (1.0 - cos_in * cos_in) / (1.6 * 1.6)).sqrt();
    let there = reflectance(1.0, &stack, 1.6, cos_in, 0.5);
    assert!((there - reflectance(1.6, &back, 1.0, cos_out, 0.5)).abs() < 1e-12);
    assert_eq!(reflectance(1.5, &[], 1.0, 0.5, 0.55), 1.0, "total reflection");
    // Beyond the film's own limit a thick film reflects all, and an absent one changes nothing.
    let film = |thickness_um| {
        [Layer {
            index: 1.2,
            thickness_um,
        }]
    };
    let cos = 0.4;
    assert!(reflectance(1.8, &film(20.0), 1.9, cos, 0.55) > 0.999_999);
    let none = reflectance(1.8, &[], 1.9, cos, 0.55);
    assert!((reflectance(1.8, &film(1e-9), 1.9, cos, 0.55) - none).abs() < 1e-6);
}

#[test]
fn files_of_every_format_give_the_same_lens() {
    let folder = tempfile::tempdir().unwrap();
    let triplet = lens("triplet");
    let toml = folder.path().join("a.toml");
    std::fs::write(&toml, to_toml(&triplet)).unwrap();
    let zemax: String = "UNIT MM X W X CM MR CPMM\nSURF 0\n  TYPE STANDARD\n  CURV 0.0 0\n  DISZ INFINITY\n".to_owned()
        + &triplet
            .surfaces
            .iter()
            .enumerate()
            .map(|(k, surface)| {
                let curvature = if surface.radius_mm == 0.0 { 0.0 } else { surface.radius_mm.recip() };
                let index = surface.glass.index(D_LINE_UM);
                let glass = if index > 1.0 {
                    format!("  GLAS ___BLANK 1 0 {index} {} 0\n", surface.glass.abbe_number())
                } else {
                    String::new()
                };
                let stop = if k == triplet.stop { "  STOP\n" } else { "" };
                format!(
                    "SURF {}\n{stop}  TYPE STANDARD\n  CURV {curvature:e} 0 0\n{glass}  DISZ {}\n  DIAM {} 1 0\n",
                    k + 1,
                    surface.thickness_mm,
                    surface.semi_diameter_mm.unwrap()
                )
            })
            .collect::<String>()
        + "SURF 8\n  TYPE STANDARD\n  CURV 0.0 0\n  DISZ 0\n";
    let utf16: Vec<u8> = [0xff, 0xfe]
        .into_iter()
        .chain(zemax.encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    let zmx = folder.path().join("a.zmx");
    std::fs::write(&zmx, utf16).unwrap();
    let sequence: String = "RDM;LEN\nTITLE 'a'\nDIM M\nSO 0.0 1e11\n".to_owned()
        + &triplet
            .surfaces
            .iter()
            .enumerate()
            .map(|(k, surface)| {
                let index = surface.glass.index(D_LINE_UM);
                let glass = if index > 1.0 {
                    format!("{index}:{}", surface.glass.abbe_number())
                } else {
                    String::new()
                };
                format!(
                    "S {} {} {glass}\n{}  CIR {}\n",
                    surface.radius_mm,
                    surface.thickness_mm,
                    if k == triplet.stop { "  STO\n" } else { "" },
                    surface.semi_diameter_mm.unwrap()
                )
            })
            .collect::<String>()
        + "SI 0 0\n";
    let seq = folder.path().join("a.seq");
    std::fs::write(&seq, sequence).unwrap();
    let expected = Paraxial::new(&triplet, 0.48, None);
    for path in [toml, zmx, seq] {
        let read = open(&path.display().to_string()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(read.stop, triplet.stop, "{}", path.display());
        let paraxial = Paraxial::new(&read, 0.48, None);
        assert!(
            (paraxial.efl_mm / expected.efl_mm - 1.0).abs() < 1e-9,
            "{}",
            path.display()
        );
        assert!(
            (paraxial.bfd_mm / expected.bfd_mm - 1.0).abs() < 1e-9,
            "{}",
            path.display()
        );
    }
}

/// Focal lengths that the sources of the fixtures state.
#[test]
fn published_lenses_have_their_focal_lengths() {
    for (name, efl_mm) in [
        ("phone", 4.55),
        ("phone_plastic", 4.10),
        ("zoom_short", 14.42),
        ("zoom_long", 29.10),
        ("sonnar", 100.0),
        ("telephoto", 400.0),
        ("biogon", 21.0),
        ("topogon", 66.477),
        ("retrofocus", 28.0),
        ("lowenthal", 100.4),
        ("dagor", 239.893),
    ] {
        let computed = Paraxial::new(&fixture(name), D_LINE_UM, None).efl_mm;
        assert!((computed / efl_mm - 1.0).abs() < 0.011, "{name}: {computed} mm");
    }
}

/// A lens made for a telephone draws nearly without distortion to 37 degrees from its axis, though rays there meet aspheres whose
/// conic alone they miss.
#[test]
fn rays_meet_aspheres_beyond_their_conics() {
    let lens = fixture("phone_plastic");
    let paraxial = Paraxial::new(&lens, D_LINE_UM, None);
    let tracer = Tracer::new(&lens, D_LINE_UM, paraxial.sensor_gap_mm());
    for degrees in 1..=37 {
        let angle = f64::from(degrees).to_radians();
        let chief = tracer.trace(None, DVec2::ZERO, beam_direction(angle));
        let height = chief
            .unwrap_or_else(|| panic!("lost at {degrees} degrees"))
            .sensor_mm
            .length();
        let ideal = paraxial.efl_mm * angle.tan();
        assert!(
            (height / ideal - 1.0).abs() < 0.03,
            "{degrees} degrees: {height}, ideal {ideal} mm"
        );
    }
}

/// A conic's focus is without aberration: one hyperbolic surface images a beam inside glass to one point.
#[test]
fn a_plano_hyperbolic_lens_has_no_spherical_aberration() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("asphere.toml");
    let n: f64 = 1.5;
    // A collimated beam inside glass leaves through a hyperboloid with conic -n².
    let table = |conic: f64, aspheric: &str| {
        format!(
            "name = \"a\"\nsurfaces = [\n{{ stop = true, thickness = 5.0, semi_diameter = 10.0 }},\n\
             {{ thickness = 10.0, n_d = {n}, semi_diameter = 10.0 }},\n\
             {{ radius = -25.0, thickness = 50.0, conic = {conic}, aspheric = [{aspheric}], semi_diameter = 10.0 }},\n]\n"
        )
    };
    let spread = |text: String| {
        std::fs::write(&file, text).unwrap();
        let lens = open(&file.display().to_string()).unwrap();
        let paraxial = Paraxial::new(&lens, D_LINE_UM, None);
        let tracer = Tracer::new(&lens, D_LINE_UM, paraxial.sensor_gap_mm());
        (1..=9)
            .map(|x| {
                let ray = tracer
                    .trace(None, DVec2::new(f64::from(x), 0.0), DVec3::Z)
                    .unwrap();
                ray.sensor_mm.x.abs()
            })
            .fold(0.0, f64::max)
    };
    assert!(spread(table(-n * n, "")) < 1e-9, "{}", spread(table(-n * n, "")));
    assert!(spread(table(0.0, "")) > 0.1, "a sphere has it");
    // The same hyperboloid as a sphere and the difference of the two sags as even powers, by Newton's steps.
    let (c, k) = (-1.0 / 25.0, -n * n);
    let term = |order: i32, k: f64| {
        // Series of the conic's sag: c r²/2 Σ binomials; coefficient of r^(2m).
        let mut coefficient = 0.5 * c;
        for m in 1..order {
            coefficient *= (1.0 + k) * c * c * f64::from(2 * m - 1) / f64::from(2 * (m + 1));
        }
        coefficient
    };
    let terms: Vec<String> = (1..=12)
        .map(|order| format!("{:e}", term(order, k) - term(order, 0.0)))
        .collect();
    assert!(spread(table(0.0, &terms.join(", "))) < 1e-7);
}

#[test]
fn unfit_files_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("empty.toml", ""),
        (
            "nostop.toml",
            "name = \"a\"\nsurfaces = [{ thickness = 1.0 }, { thickness = 2.0 }]\n",
        ),
        (
            "nan.toml",
            "name = \"a\"\nsurfaces = [{ stop = true, thickness = nan }, { thickness = 2.0 }]\n",
        ),
        ("words.dat", "one two three four\n"),
        ("short.zmx", "SURF 0\n"),
        ("short.seq", "S 1 2\n"),
        ("odd.csv", "kind,radius_mm\nlens,abc\n"),
        ("what.xyz", "1 2 3 4\n"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let error = open(&path.display().to_string()).expect_err(name).to_string();
        assert!(error.contains(name) || error.starts_with("a:"), "{error}");
    }
    let unknown = open("helier").unwrap_err().to_string();
    assert!(unknown.contains("heliar"), "{unknown}");
    assert!(!ghosts(&lens("heliar")).is_empty());
}

/// An f-number that the stop does not open to is refused; each lens's own, in round figures, is not.
#[test]
fn f_numbers_wider_than_the_lens_are_refused() {
    use rilievo::camera::lens::BUILT_IN;
    use rilievo::camera::require_f_number;
    for (name, _) in BUILT_IN {
        let lens = built_in(name).unwrap().unwrap();
        let paraxial = Paraxial::new(&lens, D_LINE_UM, None);
        let widest = paraxial.widest_f_number(&lens).unwrap();
        // The stop at that f-number is the open stop.
        let open_mm = lens.clear_radius(lens.stop);
        assert!(
            (paraxial.stop_radius(widest) / open_mm - 1.0).abs() < 1e-9,
            "{name}"
        );
        require_f_number(&lens, widest).unwrap();
        require_f_number(&lens, 22.0).unwrap();
        let refusal = require_f_number(&lens, 1.0).unwrap_err().to_string();
        assert!(
            refusal.contains(name) && refusal.contains("does not open to f/1"),
            "{refusal}"
        );
    }
}

/// No film lies in cement; zooms have more than one kind of film.
#[test]
fn films_lie_on_surfaces_that_meet_air() {
    use rilievo::camera::lens::BUILT_IN;
    for (name, _) in BUILT_IN {
        let lens = built_in(name).unwrap().unwrap();
        let mut films = Vec::new();
        for pair in lens.surfaces.windows(2) {
            let in_cement = pair.iter().all(|surface| surface.glass.index(D_LINE_UM) > 1.01);
            assert!(!in_cement || pair[1].coating.is_none(), "{name}");
        }
        for surface in &lens.surfaces {
            if let Some(coating) = &surface.coating
                && !films.contains(coating)
            {
                films.push(coating.clone());
            }
        }
        if ["nikon", "canon", "itoh"].contains(&name) {
            assert!(films.len() > 2, "{name}: {} kinds of film", films.len());
        }
    }
}
