//! The run report: report.json and its summary for people.
//!
//! What happened comes in as plain numbers ([`RunTotals`]) and thresholds ([`AcceptLimits`]);
//! what goes out is a [`Report`] of schema 1, its JSON text and a page for people.
//! This crate must never know where the numbers come from: no world, no cell, no files.
//!
//! ```
//! use depal_report::{AcceptLimits, Report, RunTotals, summary};
//! let totals = RunTotals { boxes_total: 2, boxes_delivered: 2, sim_time_s: 20.0, ..RunTotals::default() };
//! let limits = AcceptLimits { delivered_min: Some(2.0), ..AcceptLimits::default() };
//! let report = Report::new(&totals, &limits);
//! assert!(report.accept.passed);
//! assert!(report.to_json().contains("\"boxes_per_hour\": 360.0"));
//! assert!(summary(&report).starts_with("ACCEPTED"));
//! ```
//!
//! Units stand in the names (`_s`, `_ms`, `_mm`, `_deg`).
//! A figure that no sample stands behind is `null` in the JSON and a dash in the summary: a rate of
//! nothing is not zero, and a threshold on it is missed.
//!
//! Limitations: one run; comparing runs is not done here.

mod accept;
mod from_run;
mod report;
mod statistics;
mod summary;
mod totals;

pub use accept::{Accept, AcceptLimits, Check};
pub use report::{
    Boxes, CycleTimes, InterfaceCounts, MedianAndTail, MedianTailMax, Picks, Planning, Report,
    Vision,
};
pub use statistics::{mean, percentile};
pub use summary::summary;
pub use totals::RunTotals;

#[cfg(test)]
mod tests;
