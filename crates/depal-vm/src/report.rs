//! Messages that a program puts into the event log, and the interrupts that they order.

use crate::memory::{Memory, Trigger};

/// A message that a program put into the event log.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Report {
    /// The group of messages that it belongs to, as the language numbers them.
    pub domain: u32,
    /// Its number in that group.
    pub number: u32,
    /// How bad it is, as the language numbers it.
    pub severity: u32,
    /// Its heading.
    pub title: String,
    /// Its parts, in their order.
    pub texts: Vec<String>,
}

/// Which messages order an interrupt; `None` takes all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ReportFilter {
    /// Of this group.
    pub domain: Option<u32>,
    /// Of this number.
    pub number: Option<u32>,
    /// As bad as this.
    pub severity: Option<u32>,
}

impl ReportFilter {
    /// Whether it takes a message.
    pub fn takes(self, report: &Report) -> bool {
        let fits = |wanted: Option<u32>, found: u32| wanted.is_none_or(|wanted| wanted == found);
        fits(self.domain, report.domain)
            && fits(self.number, report.number)
            && fits(self.severity, report.severity)
    }
}

impl Memory {
    /// Queues the interrupts that wait for such a message, each with a copy of it.
    pub fn report(&mut self, report: &Report) {
        let interrupts = &mut self.interrupts;
        for interrupt in &mut interrupts.connected {
            let Trigger::Report(filter) = &interrupt.trigger else {
                continue;
            };
            if interrupt.asleep || !filter.takes(report) {
                continue;
            }
            interrupts.queued.push_back(interrupt.number);
            interrupts
                .reported
                .push_back((interrupt.number, report.clone()));
            if interrupt.once {
                interrupt.trigger = Trigger::None;
            }
        }
    }

    /// The message that ordered the interrupt being served; `None` if none is served or something else ordered it.
    pub fn served_report(&self) -> Option<&Report> {
        let frame = self.frames.iter().rev().find(|f| f.interrupt.is_some())?;
        frame.report.as_deref()
    }

    /// Takes the oldest message for an interrupt.
    pub(crate) fn take_report(&mut self, number: u32) -> Option<Box<Report>> {
        let reported = &mut self.interrupts.reported;
        let at = reported.iter().position(|(of, _)| *of == number)?;
        reported.remove(at).map(|(_, report)| Box::new(report))
    }
}
