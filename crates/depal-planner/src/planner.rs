use crate::{
    candidate::Candidates,
    in_order::first_in_order,
    pick::Trial,
    plan::PickPlan,
    refusal::{Refusal, Rejection},
    request::PlanRequest,
    situation::Situation,
};

/// Chooses a box and plans the way there and to the place.
///
/// Works on the threads of the rayon pool that it is called from, else of the global one; the answer is the same with any
/// number of them.
///
/// # Errors
/// [`Refusal`] lists every box with its reason.
pub fn plan_pick(request: &PlanRequest) -> Result<PickPlan, Refusal> {
    if request.boxes.is_empty() {
        return Err(Refusal::NoBoxes);
    }
    // Into the pool once, not at every choice.
    rayon::scope(|_| first_pick(&Situation::new(request)?))
}

/// The first candidate that can be picked, with the reasons of those before it.
fn first_pick(situation: &Situation) -> Result<PickPlan, Refusal> {
    let Candidates {
        layers,
        mut rejected,
    } = Candidates::choose(situation.request);
    for layer in &layers {
        // First what can be held as well as it can be: a neighbour that stands in the way may be gone by and by.
        let (trials, plan) = first_in_order(layer.iter().collect(), |group| {
            Trial::of_best_grasps(situation, group)
        });
        let mut passed: Vec<Rejection> = trials.iter().map(Trial::rejection).collect();
        if let Some(plan) = plan {
            rejected.append(&mut passed);
            return Ok(PickPlan { rejected, ..plan });
        }
        let (mut failed, plan) = first_in_order(trials, |trial| trial.with_all_grasps(situation));
        rejected.append(&mut failed);
        if let Some(plan) = plan {
            // Those that come later were turned down for their best grasps alone.
            let done = rejected.iter().map(|r| r.box_index);
            let done: Vec<usize> = done.chain([plan.box_index]).collect();
            passed.retain(|r| !done.contains(&r.box_index));
            rejected.append(&mut passed);
            return Ok(PickPlan { rejected, ..plan });
        }
    }
    Err(Refusal::NothingFits(rejected))
}
