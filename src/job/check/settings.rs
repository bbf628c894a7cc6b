//! `[quality]`, `[map]`, `[sampling]`, `[solver]`, `[shot]`, `[lookup]`, `[budget]`.

use super::{Problem, problem, require};
use crate::budget::TEXEL_BYTES;
use crate::fit::Shape;
use crate::job::Job;
use crate::methods::{Method, SolverParams};
use crate::resolution::{Bound, MapParams, Measure, QualityParams, SIZE_MAX, TEXELS_MAX};
use crate::samples::SamplingParams;
use crate::scene::VisibilitySource;
use crate::shot::{Temporal, TemporalParams};

pub(super) fn quality(quality: &QualityParams) -> Result<(), Problem> {
    let epsilon = quality.epsilon();
    match quality.bound {
        Bound::Misclassified => {
            require(
                epsilon > 0.0 && epsilon <= 1.0,
                "quality.epsilon",
                epsilon,
                "a share of the image above 0 and at most 1",
            )?;
        }
        Bound::Displacement | Bound::Footprint => {
            require(
                epsilon > 0.0 && epsilon.is_finite(),
                "quality.epsilon",
                epsilon,
                "a finite number of pixels above 0",
            )?;
        }
    }
    let quantile = quality.quantile;
    require(quantile > 0.0 && quantile <= 1.0, "quality.quantile", quantile, "above 0 and at most 1")
}

pub(super) fn map(map: &MapParams) -> Result<(), Problem> {
    let sizes = format!("1 to {SIZE_MAX} texels");
    for (key, size) in [("map.min", map.min), ("map.max", map.max), ("map.multiple_of", map.multiple_of)] {
        require((1..=SIZE_MAX).contains(&size), key, size, &sizes)?;
    }
    if map.min > map.max {
        let message = format!("max = {} is below min = {}", map.max, map.min);
        return Err(problem("map.max", message, "raise max or lower min"));
    }
    if map.power_of_two && !map.multiple_of.is_power_of_two() {
        let message = format!("no power of two is a multiple of {}", map.multiple_of);
        return Err(problem("map.multiple_of", message, "give a power of two, or set power_of_two = false"));
    }
    let smallest = if map.power_of_two {
        map.min.next_power_of_two().max(map.multiple_of)
    } else {
        map.min.next_multiple_of(map.multiple_of)
    };
    if smallest > map.max {
        let message = format!("no allowed size lies between min = {} and max = {}", map.min, map.max);
        return Err(problem("map.max", message, format!("the smallest allowed size is {smallest}: raise max to it")));
    }
    require((1.02..=2.0).contains(&map.step), "map.step", map.step, "1.02 to 2")?;
    let bias = &map.bias;
    let at_least_0 = "a finite number of at least 0";
    if let Some(constant) = bias.constant {
        require(constant >= 0.0 && constant.is_finite(), "map.bias.constant", constant, at_least_0)?;
    }
    if let Some(slope) = bias.slope {
        require(slope >= 0.0 && slope.is_finite(), "map.bias.slope", slope, at_least_0)?;
    }
    if let Some(clamp) = bias.clamp {
        require(clamp > 0.0 && clamp.is_finite(), "map.bias.clamp", clamp, "a finite number above 0")?;
    }
    Ok(())
}

/// That the smallest maps a light may get fit the memory set aside for them.
pub(super) fn texels(map: &MapParams, solver: &SolverParams) -> Result<(), Problem> {
    let maps = match solver.method {
        Method::Adaptive | Method::Edges => solver.tiles,
        Method::Partitioned => solver.maps,
        Method::Auto => solver.max_maps,
        Method::Cascades => solver.cascade_count,
        _ => 2,
    };
    // A light among the geometry has as many for each face of a cube.
    let maps = 6 * u64::from(maps);
    let least = u64::from(map.min).pow(2) * maps;
    if least <= TEXELS_MAX {
        return Ok(());
    }
    let message = format!("{maps} maps of {} x {} texels are more than {TEXELS_MAX}", map.min, map.min);
    Err(problem("map.min", message, "lower it, or allow fewer maps"))
}

pub(super) fn sampling(sampling: &SamplingParams) -> Result<(), Problem> {
    let grid = sampling.grid;
    require((8..=SIZE_MAX).contains(&grid), "sampling.grid", grid, &format!("8 to {SIZE_MAX}"))?;
    require(sampling.refine <= 24, "sampling.refine", sampling.refine, "0 to 24")?;
    require(sampling.cap >= 16, "sampling.cap", sampling.cap, "at least 16")
}

pub(super) fn solver(solver: &SolverParams) -> Result<(), Problem> {
    require(solver.rounds <= 100, "solver.rounds", solver.rounds, "0 to 100")?;
    let measured = solver.measured_rounds;
    require(measured <= 1000, "solver.measured_rounds", measured, "0 to 1000")?;
    let tolerance = solver.tolerance;
    require(tolerance > 0.0 && tolerance <= 1.0, "solver.tolerance", tolerance, "above 0 and at most 1")?;
    require((1..=64).contains(&solver.maps), "solver.maps", solver.maps, "1 to 64")?;
    require((1..=64).contains(&solver.max_maps), "solver.max_maps", solver.max_maps, "1 to 64")?;
    let saving = solver.min_saving;
    require((0.0..1.0).contains(&saving), "solver.min_saving", saving, "at least 0 and below 1")?;
    require((1..=1024).contains(&solver.tiles), "solver.tiles", solver.tiles, "1 to 1024")?;
    let infinity = solver.psm_infinity;
    require(infinity >= 1.0 && infinity.is_finite(), "solver.psm_infinity", infinity, "a finite number of at least 1")?;
    for (key, share) in [("solver.tsm_depth", solver.tsm_depth), ("solver.tsm_focus", solver.tsm_focus)] {
        require(share > 0.0 && share < 1.0, key, share, "between 0 and 1, both excluded")?;
    }
    let iterations = solver.separating_iterations;
    require((1..=100).contains(&iterations), "solver.separating_iterations", iterations, "1 to 100")?;
    require((1..=16).contains(&solver.cascade_count), "solver.cascade_count", solver.cascade_count, "1 to 16")?;
    let blend = solver.cascade_blend;
    require((0.0..=1.0).contains(&blend), "solver.cascade_blend", blend, "0 to 1")?;
    if let Some(plane) = solver.plane
        && !(plane.iter().all(|v| v.is_finite()) && plane[..3].iter().any(|v| *v != 0.0))
    {
        let remedy = "give [a, b, c, d] of a x + b y + c z + d = 0, all finite, a, b and c not all zero";
        return Err(problem("solver.plane", format!("{plane:?} is no plane"), remedy));
    }
    Ok(())
}

pub(super) fn shot(shot: &TemporalParams, map: &MapParams) -> Result<(), Problem> {
    let cost = shot.change_cost;
    require(cost >= 0.0 && cost.is_finite(), "shot.change_cost", cost, "a finite number of texels of at least 0")?;
    if let Some(most) = shot.max_segments {
        require(most >= 1, "shot.max_segments", most, "at least 1")?;
        if shot.hold.is_some() && most > 1 {
            let message = format!("hold = \"shot\" is one segment, max_segments = {most} allows more");
            return Err(problem("shot.max_segments", message, "remove one of the two"));
        }
    }
    let part = shot.hysteresis;
    require(part > 0.0 && part <= 1.0, "shot.hysteresis", part, "above 0 and at most 1")?;
    let border = shot.hysteresis_border;
    require((0.0..=0.4).contains(&border), "shot.hysteresis_border", border, "0 to 0.4")?;
    if shot.temporal == Temporal::Snapped && map.shape != Shape::Rectangle {
        let message = "snapped maps move by whole texels, and these maps may turn and warp";
        return Err(problem("shot.temporal", message, "set map.shape = \"rectangle\""));
    }
    if shot.temporal == Temporal::Snapped && map.min < 2 {
        let message = "a map of one texel cannot move by whole texels";
        return Err(problem("map.min", message, "give at least 2"));
    }
    if shot.one_size && !matches!(shot.temporal, Temporal::Shot | Temporal::Snapped) {
        let message = "one size over the shot is a matter of the modes \"shot\" and \"snapped\"";
        return Err(problem("shot.one_size", message, "remove it, or change shot.temporal"));
    }
    Ok(())
}

/// That `auto` and `best` can choose the way they do.
pub(super) fn choosing(job: &Job) -> Result<(), Problem> {
    let mode = job.shot.temporal;
    let of_one_frame = match job.solver.method {
        Method::Auto => matches!(mode, Temporal::Hysteresis | Temporal::Snapped),
        Method::Best => mode == Temporal::Hysteresis,
        _ => return Ok(()),
    };
    let name = if job.solver.method == Method::Auto { "auto" } else { "best" };
    if of_one_frame {
        let (word, message) = match mode {
            Temporal::Snapped => ("snapped", "moves one window over the shot, and maps of a partition have none"),
            _ => ("hysteresis", "holds the maps of the frame before, and each frame would choose a method of its own"),
        };
        let message = format!("\"{word}\" {message}: it does not go with solver.method = \"{name}\"");
        return Err(problem(
            "shot.temporal",
            message,
            "set shot.temporal = \"shot\" or \"per-frame\", or name a method",
        ));
    }
    if job.solver.method == Method::Best {
        let images = job.visibility.source == VisibilitySource::Aov;
        if images || job.quality.measure == Measure::Never {
            let message = "\"best\" is the best by measurement, and nothing is measured";
            let help = if images {
                "name a method, or \"auto\": planned from images, maps cannot be drawn"
            } else {
                "set quality.measure = \"always\" (the preset draft does not), or name a method"
            };
            return Err(problem("solver.method", message, help));
        }
    }
    Ok(())
}

pub(super) fn lookup(job: &Job) -> Result<(), Problem> {
    let power = job.lookup.confidence_power;
    require((0.1..=100.0).contains(&power), "lookup.confidence_power", power, "0.1 to 100")?;
    if !job.lookup.is_temporal() {
        return Ok(());
    }
    if job.quality.measure == Measure::Never {
        let message = "reprojection is a model of what is measured, and nothing is measured";
        return Err(problem(
            "lookup.temporal",
            message,
            "set quality.measure = \"always\", or lookup.temporal = \"none\"",
        ));
    }
    if job.quality.bound != Bound::Misclassified {
        let message = "reprojection is a model of wrong pixels, and quality.bound counts something else";
        let help = "set quality.bound = \"misclassified\", or lookup.temporal = \"none\"";
        return Err(problem("lookup.temporal", message, help));
    }
    Ok(())
}

pub(super) fn budget(job: &Job) -> Result<(), Problem> {
    let budget = &job.budget;
    let limits = [
        ("budget.texels_per_frame", budget.texels_per_frame, 1),
        ("budget.texels_total", budget.texels_total, 1),
        ("budget.bytes", budget.bytes, TEXEL_BYTES),
    ];
    for (key, limit, least) in limits {
        let Some(limit) = limit else { continue };
        require(limit >= least, key, limit, &format!("at least {least}"))?;
    }
    let Some((key, ..)) = limits.iter().find(|(_, limit, _)| limit.is_some()) else { return Ok(()) };
    if job.quality.bound != Bound::Misclassified {
        let message = "a budget makes wrong pixels fewest, and quality.bound counts something else";
        return Err(problem(*key, message, "set quality.bound = \"misclassified\", or remove the budget"));
    }
    if job.quality.measure == Measure::Never {
        let message = "texels are shared out by measured errors, and nothing is measured";
        let help = "set quality.measure = \"always\" (the preset draft does not), or remove the budget";
        return Err(problem(*key, message, help));
    }
    if job.shot.temporal == Temporal::Snapped {
        let message = "snapped maps move by whole texels: their matrices hang on their sizes";
        return Err(problem(*key, message, "set shot.temporal = \"shot\", or remove the budget"));
    }
    if job.shot.one_size {
        let message = "a budget gives every segment a size of its own, and shot.one_size wants one";
        return Err(problem(*key, message, "set shot.hold = \"shot\" instead of one_size, or remove the budget"));
    }
    Ok(())
}
