use depal_time::SimTime;

/// What the sequence is about to do, or does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    AwaitVision,
    CheckState,
    SetBoxSize,
    GoHome,
    StartRun,
    ChooseBranch(usize),
    FetchPath,
    FetchOutputs,
    GoToPick,
    Grip,
    AwaitVacuum(SimTime),
    GoToPlace,
    Release,
    AwaitRelease,
    GiveUpPick,
    GoToEnd,
    End,
}

impl Stage {
    /// Its name and its place in the program.
    pub(super) fn name(self) -> (&'static str, u32) {
        match self {
            Self::AwaitVision => ("AwaitVision", 1),
            Self::CheckState => ("CheckState", 2),
            Self::SetBoxSize => ("SetBoxSize", 3),
            Self::GoHome => ("GoHome", 4),
            Self::StartRun => ("StartRun", 5),
            Self::ChooseBranch(_) => ("ChooseBranch", 6),
            Self::FetchPath => ("FetchPath", 7),
            Self::FetchOutputs => ("FetchOutputs", 8),
            Self::GoToPick => ("GoToPick", 9),
            Self::Grip => ("Grip", 10),
            Self::AwaitVacuum(_) => ("AwaitVacuum", 11),
            Self::GoToPlace => ("GoToPlace", 12),
            Self::Release => ("Release", 13),
            Self::AwaitRelease => ("AwaitRelease", 14),
            Self::GiveUpPick => ("GiveUpPick", 15),
            Self::GoToEnd => ("GoToEnd", 16),
            Self::End => ("End", 17),
        }
    }
}
