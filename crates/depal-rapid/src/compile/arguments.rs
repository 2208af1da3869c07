use std::rc::Rc;

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::scope::{Access, Compiler, ParameterType, RoutineSymbol, Signature, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// The routine that a call means; reported if there is none.
    pub(crate) fn lookup_routine(&mut self, name: &Name, function: bool) -> Option<RoutineSymbol> {
        let key = name.key();
        match self.lookup(&key) {
            Some(Symbol::Routine(routine)) => return Some(routine.clone()),
            Some(Symbol::Data(data)) => {
                let declared = data.span;
                self.error(
                    Diagnostic::error(
                        "RAPID0101",
                        name.span,
                        format!("{} is data, not a routine", name.text),
                    )
                    .secondary(declared, "declared here"),
                );
                return None;
            }
            None => {}
        }
        if let Some((known, theme)) = crate::builtins::refused(&name.text) {
            self.error(
                Diagnostic::error(
                    "RAPID0112",
                    name.span,
                    format!("{known} is not simulated: {}", theme.why),
                )
                .help(theme.instead),
            );
            return None;
        }
        let kind = if function {
            "function"
        } else {
            "instruction or procedure"
        };
        let mut diagnostic = Diagnostic::error(
            "RAPID0101",
            name.span,
            format!("there is no {kind} named {}", name.text),
        );
        let near = self.nearest(&name.text, |symbol| match symbol {
            Symbol::Routine(routine) => routine.signature.result.is_some() == function,
            Symbol::Data(_) => false,
        });
        if let Some(near) = near {
            diagnostic = diagnostic.help(format!("did you mean {near}?"));
        }
        self.error(diagnostic);
        None
    }

    /// Which argument goes to which parameter; mistakes are reported.
    pub(crate) fn match_arguments<'x>(
        &mut self,
        signature: &Signature,
        name: &Name,
        arguments: &'x [Argument],
    ) -> Vec<Option<&'x Argument>> {
        let parameters = &signature.parameters;
        let mut matched: Vec<Option<&Argument>> = vec![None; parameters.len()];
        let mut next = 0;
        for argument in arguments {
            let index = match argument {
                Argument::Positional(_) => {
                    while next < parameters.len()
                        && (parameters[next].optional || group_taken(parameters, &matched, next))
                    {
                        next += 1;
                    }
                    if next == parameters.len() {
                        let wanted = parameters.iter().filter(|p| !p.optional).count();
                        self.error(
                            Diagnostic::error(
                                "RAPID0105",
                                argument.span(),
                                format!("{} takes {wanted} arguments, here is one more", name.text),
                            )
                            .help(usage(signature)),
                        );
                        break;
                    }
                    next += 1;
                    next - 1
                }
                Argument::Named { name: given, .. } | Argument::Conditional { name: given, .. } => {
                    let key = given.key();
                    let Some(index) = parameters.iter().position(|p| p.key == key) else {
                        let names = parameters.iter().map(|p| p.name.clone());
                        let mut diagnostic = Diagnostic::error(
                            "RAPID0107",
                            given.span,
                            format!("{} has no argument {} here", name.text, given.text),
                        );
                        diagnostic.help =
                            Some(match depal_syntax::nearest_name(&given.text, names) {
                                Some(near) => format!("did you mean \\{near}?"),
                                None => usage(signature),
                            });
                        self.error(diagnostic);
                        continue;
                    };
                    index
                }
            };
            if let Some(first) = matched[index] {
                self.error(
                    Diagnostic::error(
                        "RAPID0127",
                        argument.span(),
                        format!("{} is given twice", parameters[index].name),
                    )
                    .secondary(first.span(), "first given here"),
                );
                continue;
            }
            matched[index] = Some(argument);
        }
        self.check_groups(signature, name, &matched);
        matched
    }

    fn check_groups(&mut self, signature: &Signature, name: &Name, matched: &[Option<&Argument>]) {
        let parameters = &signature.parameters;
        for (index, parameter) in parameters.iter().enumerate() {
            let same = |i: &usize| parameters[*i].group == parameter.group;
            let group: Vec<usize> = (0..parameters.len()).filter(same).collect();
            if group[0] != index {
                continue;
            }
            let given: Vec<usize> = group
                .iter()
                .copied()
                .filter(|i| matched[*i].is_some())
                .collect();
            let conditional = |i: &usize| matches!(matched[*i], Some(Argument::Conditional { .. }));
            if given.len() > 1 && !given.iter().all(conditional) {
                let span = matched[given[1]].map_or(name.span, Argument::span);
                self.error(Diagnostic::error(
                    "RAPID0128",
                    span,
                    format!(
                        "{} and {} exclude each other",
                        parameters[given[0]].name, parameters[given[1]].name
                    ),
                ));
            }
            let needed = group.iter().any(|i| !parameters[*i].optional);
            if given.is_empty() && needed {
                self.error(
                    Diagnostic::error(
                        "RAPID0106",
                        name.span,
                        format!("{} needs its argument {}", name.text, parameter.name),
                    )
                    .help(usage(signature)),
                );
            }
        }
    }

    /// Lowers one value for each parameter; their number.
    pub(crate) fn arguments(
        &mut self,
        signature: &Rc<Signature>,
        name: &Name,
        arguments: &[Argument],
    ) -> u32 {
        let matched = self.match_arguments(signature, name, arguments);
        for (parameter, argument) in signature.parameters.iter().zip(&matched) {
            self.argument(parameter, *argument);
        }
        signature.parameters.len() as u32
    }

    pub(crate) fn argument(&mut self, parameter: &ParameterType, argument: Option<&Argument>) {
        match argument {
            None => {
                self.emit(Op::Push(Value::Absent));
            }
            Some(Argument::Conditional { from, .. }) => self.conditional(parameter, from),
            Some(Argument::Named { name, value: None }) => {
                if parameter.kind != Type::Switch {
                    self.error(Diagnostic::error(
                        "RAPID0129",
                        name.span,
                        format!("\\{} needs a value: \\{}:=..", name.text, name.text),
                    ));
                }
                self.emit(Op::Push(Value::Bool(true)));
            }
            Some(
                Argument::Named {
                    value: Some(value), ..
                }
                | Argument::Positional(value),
            ) => {
                if parameter.kind == Type::Switch {
                    self.error(Diagnostic::error(
                        "RAPID0129",
                        value.span,
                        format!("\\{} is a switch and takes no value", parameter.name),
                    ));
                }
                self.given(parameter, value);
            }
        }
    }

    fn given(&mut self, parameter: &ParameterType, value: &Expression) {
        if parameter.mode == Mode::Value || matches!(parameter.kind, Type::Signal(_)) {
            self.value(value, Some(&parameter.kind));
            return;
        }
        let found = self.place(value);
        if !parameter.kind.accepts(&found) {
            self.mismatch(value.span, &parameter.kind, &found);
        }
        self.check_mode(parameter, value);
    }

    fn check_mode(&mut self, parameter: &ParameterType, value: &Expression) {
        let Some(data) = self.root_data(value) else {
            return;
        };
        let refused = matches!(
            (parameter.mode, data.access),
            (_, Access::Stored(Storage::Const) | Access::LoopVariable)
                | (
                    Mode::Var,
                    Access::Stored(Storage::Pers) | Access::Parameter(Mode::Pers)
                )
                | (
                    Mode::Pers,
                    Access::Stored(Storage::Var) | Access::Parameter(Mode::Value | Mode::Var)
                )
        );
        if !refused {
            return;
        }
        let wanted = match parameter.mode {
            Mode::Var => "a VAR",
            Mode::Pers => "a PERS",
            _ => "a VAR or PERS",
        };
        let got = match data.access {
            Access::Stored(Storage::Const) => "a CONST",
            Access::Stored(Storage::Pers) | Access::Parameter(Mode::Pers) => "a PERS",
            Access::LoopVariable => "a loop variable",
            _ => "a VAR",
        };
        self.error(
            Diagnostic::error(
                "RAPID0109",
                value.span,
                format!(
                    "parameter {} needs {wanted}, {} is {got}",
                    parameter.name, data.name
                ),
            )
            .secondary(data.span, "declared here"),
        );
    }

    /// `\x?y`: hands on what the caller was given, or nothing.
    fn conditional(&mut self, parameter: &ParameterType, from: &Name) {
        let symbol = match self.lookup(&from.key()) {
            Some(Symbol::Data(data)) if data.optional => Some(data.clone()),
            _ => None,
        };
        let Some(data) = symbol else {
            self.error(Diagnostic::error(
                "RAPID0126",
                from.span,
                format!("{} is no optional parameter of this routine", from.text),
            ));
            self.emit(Op::Push(Value::Absent));
            return;
        };
        let Slot::Local(slot) = data.slot else {
            return;
        };
        if !parameter.kind.accepts(&data.kind) {
            self.mismatch(from.span, &parameter.kind, &data.kind);
        }
        let missing = {
            self.emit(Op::IsPresent(slot));
            self.emit(Op::JumpIfFalse(0))
        };
        let by_value = parameter.mode == Mode::Value || matches!(parameter.kind, Type::Signal(_));
        self.emit(if by_value {
            Op::LoadLocal(slot)
        } else {
            Op::PlaceLocal(slot)
        });
        let over = self.emit(Op::Jump(0));
        self.patch_here(missing);
        self.emit(Op::Push(Value::Absent));
        self.patch_here(over);
    }

    /// Reports if data cannot be assigned to.
    pub(crate) fn check_assignable(&mut self, target: &Expression) {
        let Some(data) = self.root_data(target) else {
            return;
        };
        let what = match data.access {
            Access::Stored(Storage::Const) => "a constant",
            Access::LoopVariable => "the loop variable of FOR",
            _ => return,
        };
        let span: Span = target.span;
        self.error(
            Diagnostic::error(
                "RAPID0109",
                span,
                format!("{} is {what} and cannot be assigned to", data.name),
            )
            .secondary(data.span, "declared here"),
        );
    }
}

/// The heading in words, for messages.
fn usage(signature: &Signature) -> String {
    let mut text = format!("usage: {}", signature.name);
    for (i, parameter) in signature.parameters.iter().enumerate() {
        if parameter.optional {
            text.push_str(" [\\");
            text.push_str(&parameter.name);
            text.push(']');
        } else {
            text.push_str(if i == 0 { " " } else { ", " });
            text.push_str(&parameter.name);
        }
    }
    text
}

/// Whether another alternative of a parameter was given.
fn group_taken(parameters: &[ParameterType], matched: &[Option<&Argument>], index: usize) -> bool {
    parameters
        .iter()
        .zip(matched)
        .any(|(p, m)| p.group == parameters[index].group && m.is_some())
}
