//! How the viewer opens the recording.

use rerun::blueprint::components::{PanelState, PlayState};
use rerun::blueprint::{
    Blueprint, BlueprintPanel, Horizontal, SelectionPanel, Spatial2DView, Spatial3DView,
    StateTimelineView, Tabs, TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};

/// Cell on the left; depth image, cycle, vacuum and logs on the right. Opens at the last instant.
pub(crate) fn blueprint() -> Blueprint {
    let cell = Spatial3DView::new("Cell").with_origin("/").with_contents([
        "+ /world/**",
        "- /world/camera/image/**",
        "+ /vision/estimates",
        "+ /vision/truth",
        "+ /plan/**",
        "+ /failures/**",
    ]);
    let depth = Spatial2DView::new("Depth image")
        .with_origin("/world/camera/image")
        .with_contents(["+ /world/camera/image/**"]);
    let cycle = StateTimelineView::new("Cycle").with_contents(["+ /cycle"]);
    let vacuum = TimeSeriesView::new("Vacuum, kPa").with_contents(["+ /gripper/vacuum/**"]);
    let logs = Tabs::new([
        TextLogView::new("Events")
            .with_contents(["+ /log/**"])
            .into(),
        TextLogView::new("Protocol")
            .with_contents(["+ /protocol/**"])
            .into(),
        TextLogView::new("Program")
            .with_contents(["+ /program/**"])
            .into(),
        TimeSeriesView::new("Joints, deg")
            .with_contents(["+ /robot/joints/**"])
            .into(),
        TimeSeriesView::new("Signals")
            .with_contents(["+ /signals/**"])
            .into(),
        TimeSeriesView::new("Vision error")
            .with_contents(["+ /vision/error/**"])
            .into(),
        TextDocumentView::new("Readme")
            .with_contents(["+ /readme"])
            .into(),
    ]);
    let side = Vertical::new([depth.into(), cycle.into(), vacuum.into(), logs.into()])
        .with_row_shares(vec![3.0, 1.0, 1.5, 2.0]);
    Blueprint::new(Horizontal::new([cell.into(), side.into()]).with_column_shares(vec![3.0, 2.0]))
        .with_auto_views(false)
        .with_auto_layout(false)
        .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Collapsed))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
        .with_time_panel(
            TimePanel::new()
                .with_state(PanelState::Collapsed)
                .with_timeline("sim_time")
                .with_play_state(PlayState::Following),
        )
}
