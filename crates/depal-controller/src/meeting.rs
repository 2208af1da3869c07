use std::task::Poll;

use depal_vm::system::Fault;

use crate::Cabinet;

/// A place where tasks wait for each other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Meeting {
    /// Numbers of the tasks that wait.
    waiting: Vec<usize>,
    /// Numbers of those that may go on and have not been told yet.
    released: Vec<usize>,
}

impl Cabinet {
    /// The task under way waits at a point until all of `names` do.
    pub(crate) fn meet(&mut self, point: &str, names: &[String]) -> Poll<Result<(), Fault>> {
        let own = self.current;
        let point = point.to_lowercase();
        if let Some(meeting) = self.meetings.get_mut(&point)
            && let Some(position) = meeting.released.iter().position(|task| *task == own)
        {
            meeting.released.remove(position);
            return Poll::Ready(Ok(()));
        }
        let mut expected = Vec::new();
        for name in names {
            let is_named =
                |task: &crate::task::TaskRecord| task.role.name.eq_ignore_ascii_case(name);
            let Some(task) = self.tasks.iter().position(is_named) else {
                return Poll::Ready(Err(Fault::NotThere {
                    message: format!("a task {name} to meet at {point}"),
                }));
            };
            expected.push(task);
        }
        if !expected.contains(&own) {
            return Poll::Ready(Err(Fault::NotThere {
                message: format!(
                    "the task {} among those that meet at {point}",
                    self.tasks[own].role.name
                ),
            }));
        }
        let meeting = self.meetings.entry(point).or_default();
        if !meeting.waiting.contains(&own) {
            meeting.waiting.push(own);
        }
        if !expected.iter().all(|task| meeting.waiting.contains(task)) {
            return Poll::Pending;
        }
        meeting.waiting.retain(|task| !expected.contains(task));
        meeting.released = expected.into_iter().filter(|task| *task != own).collect();
        // Those that wait are asked again in the next cycle at the latest.
        self.looked.set(true);
        Poll::Ready(Ok(()))
    }

    /// The task under way waits no longer.
    pub(crate) fn leave_meeting(&mut self, point: &str) {
        if let Some(meeting) = self.meetings.get_mut(&point.to_lowercase()) {
            meeting.waiting.retain(|task| *task != self.current);
        }
    }
}
