use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::scope::*;
use super::types::{Family, Type};
use crate::builtins::{MoveForm, PathShape};
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// The built-in takes the form of the move, its points and the angle of an arc.
    pub(super) fn movement(&mut self, movement: &Move, span: Span) {
        let restored = self.settings_of_one_move(&movement.with);
        let mut form = MoveForm {
            shape: match movement.word {
                MoveWord::Ptp | MoveWord::PtpRel | MoveWord::Sptp => PathShape::Joint,
                MoveWord::Lin | MoveWord::LinRel | MoveWord::Slin => PathShape::Line,
                MoveWord::Circ | MoveWord::CircRel | MoveWord::Scirc => PathShape::Arc,
            },
            relative: matches!(
                movement.word,
                MoveWord::PtpRel | MoveWord::LinRel | MoveWord::CircRel
            ),
            spline: matches!(
                movement.word,
                MoveWord::Sptp | MoveWord::Slin | MoveWord::Scirc
            ),
            ..MoveForm::default()
        };
        match movement.frame.as_ref().map(Name::key).as_deref() {
            None | Some("base") => {}
            Some("tool") => form.in_tool = true,
            Some(other) => {
                let span = movement.frame.as_ref().map_or(span, |f| f.span);
                self.error(
                    Diagnostic::error("KRL0112", span, format!("no move refers to #{other}"))
                        .help("write #BASE or #TOOL"),
                );
            }
        }
        for word in &movement.approximation {
            match word.key().as_str() {
                "c_ptp" => form.c_ptp = true,
                "c_dis" => form.c_dis = true,
                "c_vel" => form.c_vel = true,
                "c_ori" => form.c_ori = true,
                // What the spline moves call their approximation.
                _ if form.shape == PathShape::Joint => form.c_ptp = true,
                _ => form.c_dis = true,
            }
        }
        for point in &movement.points {
            let family = self.point(point);
            match family {
                Some(Family::Axes) if form.shape == PathShape::Joint => form.axes = true,
                Some(Family::Axes) => {
                    self.error(
                        Diagnostic::error(
                            "KRL0104",
                            point.span,
                            format!(
                                "{} needs a position, found axis angles",
                                movement.word.text()
                            ),
                        )
                        .help("FORWARD computes the position, or move with PTP"),
                    );
                }
                _ => {}
            }
        }
        if movement.points.len() < 2 {
            self.emit(Op::Push(Value::Absent));
        }
        match &movement.angle {
            Some(angle) => {
                self.value(angle, Some(&Type::Real));
            }
            None => {
                self.emit(Op::Push(Value::Absent));
            }
        }
        self.emit(Op::Push(Value::Int(form.encode())));
        self.emit_builtin("move", 4, false);
        for (target, slot) in restored {
            self.place(&target);
            self.emit(Op::LoadLocal(slot));
            self.emit(Op::StorePlace);
        }
    }

    /// Puts a point as E6POS or E6AXIS.
    fn point(&mut self, point: &Expression) -> Option<Family> {
        let found = self.any_value(point, None);
        let family = self.types.family(&found);
        let wanted = match family {
            Some(Family::Pose) => self.types.struc("E6POS"),
            Some(Family::Axes) => self.types.struc("E6AXIS"),
            None => {
                if found != Type::Broken {
                    let wanted = self.types.struc("E6POS");
                    self.mismatch(point.span, &wanted, &found);
                }
                return None;
            }
        };
        self.convert(&wanted, &found);
        family
    }

    /// WITH: variables of the system that hold for one move. Gives back where the values before are.
    fn settings_of_one_move(
        &mut self,
        settings: &[(Expression, Expression)],
    ) -> Vec<(Expression, u32)> {
        let mut restored = Vec::new();
        for (target, value) in settings {
            if !self.is_place(target) {
                self.place(target);
                self.emit(Op::Pop);
                continue;
            }
            let slot = self.new_local(Value::Unset);
            // Copied as it is: it may have no value.
            self.place(target);
            self.emit_builtin("copy", 1, true);
            self.emit(Op::SetLocal(slot));
            self.assign(target, value);
            restored.push((target.clone(), slot));
        }
        restored.reverse();
        restored
    }
}
