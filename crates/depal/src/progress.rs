//! How far a run is: a bar on a terminal, a plain line every simulated minute elsewhere.

use std::io::IsTerminal;

use depal_cell::cell::Cell;
use depal_cell::score::CartonFate;
use depal_time::SimDuration;
use indicatif::{ProgressBar, ProgressStyle};

/// The progress of one run, on stderr.
pub struct Progress {
    bar: Option<ProgressBar>,
    total: usize,
    time_limit: SimDuration,
}

impl Progress {
    /// A run over `total` cartons.
    pub fn start(total: usize, time_limit: SimDuration) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:32} {pos}/{len} cartons  {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(total as u64).with_style(style)
        });
        Self {
            bar,
            total,
            time_limit,
        }
    }

    /// Called once a simulated second.
    pub fn update(&self, cell: &Cell) {
        let placed = cell
            .score()
            .count(|fate| matches!(fate, CartonFate::Delivered | CartonFate::OnConveyor));
        let seconds = cell.now().as_secs_f64();
        let text = format!(
            "{} picks, {seconds:.0} s of at most {:.0} s",
            cell.score().picks.len(),
            self.time_limit.as_secs_f64()
        );
        if let Some(bar) = &self.bar {
            bar.set_position(placed as u64);
            bar.set_message(text);
        } else if (seconds.round() as u64).is_multiple_of(60) {
            tell!("{placed}/{} cartons, {text}", self.total);
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
