use std::collections::BTreeSet;

use depal_vm::SourceFile;

use crate::syntax::parse;
use crate::syntax::tree::*;

/// What a signal of a listing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SignalKind {
    /// A digital input (DI, RI, UI, SI).
    DigitalInput,
    /// A digital output (DO, RO, UO, SO).
    DigitalOutput,
    /// A group input.
    GroupInput,
    /// A group output.
    GroupOutput,
    /// An analogue input.
    AnalogInput,
    /// An analogue output.
    AnalogOutput,
}

/// A signal that listings name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct SignalUse {
    /// `DO[1]`.
    pub name: String,
    /// What it is.
    pub kind: SignalKind,
}

/// All signals that listings name by a number, in the order of their names. Those whose number is computed are not
/// among them, nor flags and markers, which are the program's own.
pub fn signals_used(sources: &[SourceFile]) -> Vec<SignalUse> {
    let mut found = BTreeSet::new();
    for (index, source) in sources.iter().enumerate() {
        for listing in parse(index as u32, &source.text, &mut Vec::new()) {
            for line in &listing.lines {
                statement(&line.statement, &mut found);
            }
        }
    }
    found.into_iter().collect()
}

type Found = BTreeSet<SignalUse>;

fn statement(statement: &Statement, found: &mut Found) {
    match statement {
        Statement::Action(a) | Statement::CaseElse(a) => action(a, found),
        Statement::Run(call) => call.arguments.iter().for_each(|a| expression(a, found)),
        Statement::If(condition, a) => {
            expression(condition, found);
            action(a, found);
        }
        Statement::IfThen(e) | Statement::WaitSeconds(e) | Statement::SkipCondition(e) => {
            expression(e, found);
        }
        Statement::For { from, to, .. } => {
            expression(from, found);
            expression(to, found);
        }
        Statement::Select {
            subject,
            value,
            action: a,
        } => {
            expression(subject, found);
            expression(value, found);
            action(a, found);
        }
        Statement::Case { value, action: a } => {
            expression(value, found);
            action(a, found);
        }
        Statement::WaitUntil { condition, .. } => expression(condition, found),
        Statement::Motion(motion) => {
            expression(&motion.target, found);
            for along in &motion.options.along {
                action(&along.action, found);
            }
        }
        _ => {}
    }
}

fn action(action: &Action, found: &mut Found) {
    match action {
        Action::Assign(target, change) => {
            item(target, found);
            if let Change::Value(value) = change {
                expression(value, found);
            }
        }
        Action::Call(call) => call.arguments.iter().for_each(|a| expression(a, found)),
        _ => {}
    }
}

fn expression(expr: &Expr, found: &mut Found) {
    match &expr.kind {
        ExprKind::Item(i) => item(i, found),
        ExprKind::Negate(e) | ExprKind::Not(e) => expression(e, found),
        ExprKind::Binary(_, a, b) => {
            expression(a, found);
            expression(b, found);
        }
        ExprKind::Function(_, arguments) => arguments.iter().for_each(|a| expression(a, found)),
        _ => {}
    }
}

fn item(item: &Item, found: &mut Found) {
    let kind = match item.kind {
        ItemKind::Di | ItemKind::Ri | ItemKind::Ui | ItemKind::Si => Some(SignalKind::DigitalInput),
        ItemKind::Do | ItemKind::Ro | ItemKind::Uo | ItemKind::So => {
            Some(SignalKind::DigitalOutput)
        }
        ItemKind::Gi => Some(SignalKind::GroupInput),
        ItemKind::Go => Some(SignalKind::GroupOutput),
        ItemKind::Ai => Some(SignalKind::AnalogInput),
        ItemKind::Ao => Some(SignalKind::AnalogOutput),
        _ => None,
    };
    if let (Some(kind), Some(ExprKind::Number { value, .. })) =
        (kind, item.indexes.first().map(|i| &i.kind))
    {
        found.insert(SignalUse {
            name: format!("{}[{value}]", item.kind.name()),
            kind,
        });
    }
    item.indexes.iter().for_each(|e| expression(e, found));
}
