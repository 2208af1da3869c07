//! The run report: report.json and its summary for people.
