use std::sync::Arc;

use depal_vm::{BinaryOp, Diagnostic, Op, Span, UnaryOp, Value};

use super::scope::{Access, Callee, DataSymbol, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

/// Largest whole number that a num literal holds exactly; a larger literal is a dnum.
const NUM_INTEGER_LIMIT: f64 = 8_388_608.0;

impl Compiler<'_> {
    /// Lowers a value and checks it against `expected`. Signals are read unless a signal is expected.
    pub(crate) fn value(&mut self, expression: &Expression, expected: Option<&Type>) -> Type {
        let found = self.any_value(expression, expected);
        if let (Type::Signal(None), Some(Type::Signal(Some(kind))), ExpressionKind::Name(name)) =
            (&found, expected, &expression.kind)
            && let Some((_, taken)) = self.taken_signals.get_mut(&name.to_lowercase())
        {
            taken.get_or_insert(*kind);
        }
        let found = match (found, expected) {
            (Type::Signal(kind), Some(Type::Signal(_) | Type::Any)) => Type::Signal(kind),
            (Type::Signal(_), _) => {
                self.emit(Op::ReadSignal);
                Type::Num
            }
            (found, _) => found,
        };
        if let Some(expected) = expected
            && !expected.accepts(&found)
        {
            self.mismatch(expression.span, expected, &found);
            return Type::Broken;
        }
        found
    }

    pub(crate) fn mismatch(&mut self, span: Span, expected: &Type, found: &Type) {
        let (wanted, got) = (self.type_name(expected), self.type_name(found));
        let mut diagnostic =
            Diagnostic::error("RAPID0104", span, format!("expected {wanted}, found {got}"))
                .label(format!("this is {got}"));
        diagnostic.help = match (expected, found) {
            (Type::Num, Type::Dnum) => Some("convert with DnumToNum(..)".into()),
            (Type::Dnum, Type::Num) => Some("convert with NumToDnum(..)".into()),
            (Type::Text, Type::Num | Type::Dnum) => {
                Some("convert with NumToStr(.., decimals) or ValToStr(..)".into())
            }
            (Type::Bool, Type::Num) => Some("compare it: .. = 1".into()),
            _ => None,
        };
        self.error(diagnostic);
    }

    fn any_value(&mut self, expression: &Expression, expected: Option<&Type>) -> Type {
        let span = expression.span;
        match &expression.kind {
            ExpressionKind::Number { value, integer } => {
                let dnum = match expected {
                    Some(Type::Dnum) => true,
                    Some(Type::Num) => false,
                    _ => *integer && value.abs() > NUM_INTEGER_LIMIT,
                };
                if dnum {
                    self.emit(Op::Push(Value::Dnum(*value)));
                    Type::Dnum
                } else {
                    self.emit(Op::Push(Value::Num(*value as f32)));
                    Type::Num
                }
            }
            ExpressionKind::Text(text) => {
                self.emit(Op::Push(Value::Str(text.clone())));
                Type::Text
            }
            ExpressionKind::Bool(value) => {
                self.emit(Op::Push(Value::Bool(*value)));
                Type::Bool
            }
            ExpressionKind::Name(name) => self.name_value(name, span),
            ExpressionKind::Field(..) | ExpressionKind::Index(..) => {
                if is_place(expression) {
                    let kind = self.place(expression);
                    self.emit(Op::LoadPlace);
                    kind
                } else {
                    self.part_of_value(expression)
                }
            }
            ExpressionKind::Call { name, arguments } => self.call_value(name, arguments, span),
            ExpressionKind::Aggregate(items) => self.aggregate(items, span, expected),
            ExpressionKind::Negate(operand) => {
                let found = self.value(operand, expected.filter(|t| t.is_number()));
                if !found.is_number() && !matches!(found, Type::Record(_)) {
                    self.operand_error(operand.span, "minus", &found);
                }
                self.emit(Op::Unary(UnaryOp::Negate));
                found
            }
            ExpressionKind::Not(operand) => {
                self.value(operand, Some(&Type::Bool));
                self.emit(Op::Unary(UnaryOp::Not));
                Type::Bool
            }
            ExpressionKind::Binary(operator, left, right) => {
                self.binary(*operator, left, right, expected)
            }
            ExpressionKind::Broken => {
                self.emit(Op::Push(Value::Absent));
                Type::Broken
            }
        }
    }

    fn operand_error(&mut self, span: Span, operator: &str, found: &Type) {
        let got = self.type_name(found);
        self.error(Diagnostic::error(
            "RAPID0104",
            span,
            format!("{operator} does not take {got}"),
        ));
    }

    fn name_value(&mut self, name: &str, span: Span) -> Type {
        let key = name.to_lowercase();
        match self.lookup(&key).cloned() {
            Some(Symbol::Data(data)) => {
                match data.slot {
                    Slot::Global(slot) => self.emit(Op::LoadGlobal(slot)),
                    Slot::Local(slot) => self.emit(Op::LoadLocal(slot)),
                };
                data.kind
            }
            Some(Symbol::Routine(routine)) => {
                let help = if routine.signature.result.is_some() {
                    format!("call it with parentheses: {name}(..)")
                } else {
                    "a procedure has no value".into()
                };
                self.error(
                    Diagnostic::error("RAPID0111", span, format!("{name} is a routine, not data"))
                        .help(help),
                );
                self.emit(Op::Push(Value::Absent));
                Type::Broken
            }
            None if key == "errno" => {
                self.emit(Op::LoadErrorNumber);
                Type::Num
            }
            None if key == "intno" => {
                self.emit(Op::LoadInterruptNumber);
                Type::Num
            }
            None => self.signal_or_unknown(name, &key, span),
        }
    }

    fn signal_or_unknown(&mut self, name: &str, key: &str, span: Span) -> Type {
        if let Some((spelled, kind)) = self.lookup_signal(key) {
            self.emit(Op::Push(Value::Signal(Arc::from(spelled))));
            return Type::Signal(Some(kind));
        }
        if let Some((_, number)) = crate::errors::ERRORS
            .iter()
            .find(|(error, _)| error.eq_ignore_ascii_case(name))
        {
            self.emit(Op::Push(Value::Num(*number as f32)));
            return Type::Num;
        }
        if self.any_signal {
            let taken = self.taken_signals.entry(key.to_owned());
            taken.or_insert_with(|| (name.to_owned(), None));
            self.emit(Op::Push(Value::Signal(Arc::from(name))));
            self.error(
                Diagnostic::warning(
                    "RAPID0102",
                    span,
                    format!("{name} is not declared; taken as a signal of the controller"),
                )
                .help("check together with the cell to know its signals"),
            );
            return Type::Signal(None);
        }
        let mut diagnostic = Diagnostic::error(
            "RAPID0100",
            span,
            format!("there are no data and no signal named {name}"),
        );
        if let Some(near) = self.nearest(name, |s| matches!(s, Symbol::Data(_))) {
            diagnostic = diagnostic.help(format!("did you mean {near}?"));
        }
        self.error(diagnostic);
        self.emit(Op::Push(Value::Absent));
        Type::Broken
    }

    /// A component of what a function returned.
    fn part_of_value(&mut self, expression: &Expression) -> Type {
        match &expression.kind {
            ExpressionKind::Field(inner, field) => {
                let kind = self.any_value(inner, None);
                let (index, kind) = self.field(&kind, field);
                self.emit(Op::Field(index));
                kind
            }
            ExpressionKind::Index(inner, indexes) => {
                let kind = self.any_value(inner, None);
                let kind = self.indexes(&kind, indexes, expression.span);
                self.emit(Op::Index(indexes.len() as u32));
                kind
            }
            _ => self.any_value(expression, None),
        }
    }

    fn field(&mut self, kind: &Type, field: &Name) -> (u32, Type) {
        let Type::Record(record) = kind else {
            if *kind != Type::Broken {
                let got = self.type_name(kind);
                self.error(Diagnostic::error(
                    "RAPID0113",
                    field.span,
                    format!("{got} has no components, so no {}", field.text),
                ));
            }
            return (0, Type::Broken);
        };
        let fields = &self.records[*record].fields;
        if let Some(index) = fields
            .iter()
            .position(|(name, _)| name.eq_ignore_ascii_case(&field.text))
        {
            return (index as u32, fields[index].1.clone());
        }
        let names: Vec<String> = fields.iter().map(|(name, _)| name.clone()).collect();
        let record = self.records[*record].name.clone();
        self.error(
            Diagnostic::error(
                "RAPID0113",
                field.span,
                format!("{record} has no component {}", field.text),
            )
            .help(format!("it has {}", names.join(", "))),
        );
        (0, Type::Broken)
    }

    fn indexes(&mut self, kind: &Type, indexes: &[Expression], span: Span) -> Type {
        for index in indexes {
            let found = self.value(index, None);
            if !found.is_number() {
                self.mismatch(index.span, &Type::Num, &found);
            }
        }
        match kind {
            Type::Array { element, sizes } => {
                if sizes.len() != indexes.len() {
                    self.error(Diagnostic::error(
                        "RAPID0114",
                        span,
                        format!(
                            "the array has {} dimensions, {} indexes are given",
                            sizes.len(),
                            indexes.len()
                        ),
                    ));
                    return Type::Broken;
                }
                for (index, size) in indexes.iter().zip(sizes) {
                    if let ExpressionKind::Number { value, .. } = index.kind
                        && *size > 0
                        && !(1.0..=*size as f64).contains(&value.round())
                    {
                        self.error(Diagnostic::error(
                            "RAPID0114",
                            index.span,
                            format!("the index {value} is outside 1..{size}"),
                        ));
                    }
                }
                (**element).clone()
            }
            Type::Broken => Type::Broken,
            other => {
                let got = self.type_name(other);
                self.error(Diagnostic::error(
                    "RAPID0114",
                    span,
                    format!("{got} is no array"),
                ));
                Type::Broken
            }
        }
    }

    /// Puts a reference to data or a part of them.
    pub(crate) fn place(&mut self, expression: &Expression) -> Type {
        match &expression.kind {
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()).cloned() {
                Some(Symbol::Data(data)) => {
                    match data.slot {
                        Slot::Global(slot) => self.emit(Op::PlaceGlobal(slot)),
                        Slot::Local(slot) => self.emit(Op::PlaceLocal(slot)),
                    };
                    data.kind
                }
                _ => self.name_value(name, expression.span),
            },
            ExpressionKind::Field(inner, field) => {
                let kind = self.place(inner);
                let (index, kind) = self.field(&kind, field);
                self.emit(Op::PlaceField(index));
                kind
            }
            ExpressionKind::Index(inner, indexes) => {
                let kind = self.place(inner);
                let kind = self.indexes(&kind, indexes, expression.span);
                self.emit(Op::PlaceIndex(indexes.len() as u32));
                kind
            }
            _ => {
                self.error(Diagnostic::error(
                    "RAPID0108",
                    expression.span,
                    "a variable is needed here, not a value",
                ));
                Type::Broken
            }
        }
    }

    /// The data that a place is part of.
    pub(crate) fn root_data(&self, expression: &Expression) -> Option<DataSymbol> {
        match &expression.kind {
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()) {
                Some(Symbol::Data(data)) => Some(data.clone()),
                _ => None,
            },
            ExpressionKind::Field(inner, _) | ExpressionKind::Index(inner, _) => {
                self.root_data(inner)
            }
            _ => None,
        }
    }

    fn aggregate(&mut self, items: &[Expression], span: Span, expected: Option<&Type>) -> Type {
        let Some(expected) = expected else {
            self.error(
                Diagnostic::error(
                    "RAPID0123",
                    span,
                    "the type of this aggregate cannot be told here",
                )
                .help("assign it to declared data first"),
            );
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        };
        let (wanted, kinds, op): (usize, Vec<Type>, Op) = match expected {
            Type::Record(record) => {
                let kinds: Vec<Type> = self.records[*record]
                    .fields
                    .iter()
                    .map(|(_, kind)| kind.clone())
                    .collect();
                (kinds.len(), kinds, Op::MakeRecord(items.len() as u32))
            }
            Type::Array { element, sizes } => {
                let inner = if sizes.len() > 1 {
                    Type::Array {
                        element: element.clone(),
                        sizes: sizes[1..].to_vec(),
                    }
                } else {
                    (**element).clone()
                };
                let size = if sizes[0] == 0 { items.len() } else { sizes[0] };
                let op = Op::MakeArray(items.len() as u32);
                (size, vec![inner; items.len()], op)
            }
            Type::Broken => {
                self.emit(Op::Push(Value::Absent));
                return Type::Broken;
            }
            other => {
                let wanted = self.type_name(other);
                self.error(Diagnostic::error(
                    "RAPID0104",
                    span,
                    format!("expected {wanted}, found an aggregate"),
                ));
                self.emit(Op::Push(Value::Absent));
                return Type::Broken;
            }
        };
        if wanted != items.len() {
            let name = self.type_name(expected);
            self.error(Diagnostic::error(
                "RAPID0124",
                span,
                format!(
                    "{name} has {wanted} components, this aggregate has {}",
                    items.len()
                ),
            ));
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        }
        let begin = self.body.code.len();
        for (item, kind) in items.iter().zip(&kinds) {
            self.value(item, Some(kind));
        }
        let constant = self.body.code[begin..]
            .iter()
            .all(|op| matches!(op, Op::Push(_)));
        if constant && self.body.code.len() - begin == items.len() {
            let values: Vec<Value> = self
                .body
                .code
                .drain(begin..)
                .map(|op| match op {
                    Op::Push(value) => value,
                    _ => Value::Absent,
                })
                .collect();
            self.emit(Op::Push(match op {
                Op::MakeRecord(_) => Value::Record(values),
                _ => Value::Array(values),
            }));
        } else {
            self.emit(op);
        }
        expected.clone()
    }

    fn binary(
        &mut self,
        operator: Operator,
        left: &Expression,
        right: &Expression,
        expected: Option<&Type>,
    ) -> Type {
        if matches!(operator, Operator::And | Operator::Or | Operator::Xor) {
            return self.logical(operator, left, right);
        }
        let comparison = matches!(
            operator,
            Operator::Equal
                | Operator::NotEqual
                | Operator::Less
                | Operator::LessOrEqual
                | Operator::Greater
                | Operator::GreaterOrEqual
        );
        let hint = expected.filter(|t| !comparison && matches!(t, Type::Num | Type::Dnum));
        let begin = self.body.code.len();
        let left_hint = hint.filter(|_| is_literal_number(left));
        let left_aggregate = matches!(left.kind, ExpressionKind::Aggregate(_));
        let mut left_kind = if left_aggregate {
            self.value(left, expected)
        } else {
            self.value(left, left_hint)
        };
        let middle = self.body.code.len();
        let right_hint =
            if is_literal_number(right) || matches!(right.kind, ExpressionKind::Aggregate(_)) {
                Some(left_kind.clone())
                    .filter(|t| *t != Type::Broken && *t != Type::Text && *t != Type::Bool)
            } else {
                None
            };
        // A number times a literal record, a record times a literal number: no hint for the number.
        let right_hint =
            right_hint.filter(|t| !is_literal_number(right) || matches!(t, Type::Num | Type::Dnum));
        let right_kind = self.value(right, right_hint.as_ref());
        if right_kind == Type::Dnum && left_kind == Type::Num && is_literal_number(left) {
            // Literals take the width of the other side; their code has the same length in both.
            let tail = self.body.code.split_off(middle);
            self.body.code.truncate(begin);
            left_kind = self.value(left, Some(&Type::Dnum));
            self.body.code.extend(tail);
        }
        self.operation(operator, &left_kind, &right_kind, left.span.to(right.span))
    }

    fn operation(&mut self, operator: Operator, left: &Type, right: &Type, span: Span) -> Type {
        let op = match operator {
            Operator::Add => BinaryOp::Add,
            Operator::Subtract => BinaryOp::Subtract,
            Operator::Multiply => BinaryOp::Multiply,
            Operator::Divide => BinaryOp::Divide,
            Operator::Div => BinaryOp::IntegerDivide,
            Operator::Mod => BinaryOp::Remainder,
            Operator::Equal => BinaryOp::Equal,
            Operator::NotEqual => BinaryOp::NotEqual,
            Operator::Less => BinaryOp::Less,
            Operator::LessOrEqual => BinaryOp::LessOrEqual,
            Operator::Greater => BinaryOp::Greater,
            Operator::GreaterOrEqual => BinaryOp::GreaterOrEqual,
            Operator::And => BinaryOp::And,
            Operator::Or => BinaryOp::Or,
            Operator::Xor => BinaryOp::Xor,
        };
        if *left == Type::Broken || *right == Type::Broken {
            self.emit(Op::Binary(op));
            return match operator {
                Operator::Add
                | Operator::Subtract
                | Operator::Multiply
                | Operator::Divide
                | Operator::Div
                | Operator::Mod => Type::Broken,
                _ => Type::Bool,
            };
        }
        match operator {
            Operator::Equal | Operator::NotEqual if left.accepts(right) => {
                if !matches!(left, Type::Socket | Type::Clock | Type::Raw) {
                    self.emit(Op::Binary(op));
                    return Type::Bool;
                }
            }
            Operator::Less
            | Operator::LessOrEqual
            | Operator::Greater
            | Operator::GreaterOrEqual
                if left == right && left.is_number() =>
            {
                self.emit(Op::Binary(op));
                return Type::Bool;
            }
            Operator::Add if *left == Type::Text && *right == Type::Text => {
                self.emit(Op::Binary(op));
                return Type::Text;
            }
            Operator::Add
            | Operator::Subtract
            | Operator::Multiply
            | Operator::Divide
            | Operator::Div
            | Operator::Mod
                if left == right && left.is_number() =>
            {
                self.emit(Op::Binary(op));
                return left.clone();
            }
            _ => {
                if let Some((builtin, kind)) = self.record_operation(operator, left, right) {
                    self.emit(Op::CallBuiltin {
                        builtin,
                        arguments: 2,
                        result: true,
                    });
                    return kind;
                }
            }
        }
        let (a, b) = (self.type_name(left), self.type_name(right));
        let mut diagnostic = Diagnostic::error(
            "RAPID0104",
            span,
            format!("{} does not take {a} and {b}", operator_name(operator)),
        );
        if matches!(
            (left, right),
            (Type::Num, Type::Dnum) | (Type::Dnum, Type::Num)
        ) {
            diagnostic = diagnostic.help("convert one side with NumToDnum(..) or DnumToNum(..)");
        }
        self.error(diagnostic);
        Type::Broken
    }

    /// Sums and products of positions and orientations are built-ins with names that no program can write.
    fn record_operation(
        &self,
        operator: Operator,
        left: &Type,
        right: &Type,
    ) -> Option<(u32, Type)> {
        let name = match operator {
            Operator::Add => "+",
            Operator::Subtract => "-",
            Operator::Multiply => "*",
            Operator::Divide => "/",
            _ => return None,
        };
        let (a, b) = (self.type_name(left), self.type_name(right));
        let index = self.table.operator(&format!("{a} {name} {b}"))?;
        let result = if matches!(left, Type::Record(_)) {
            left.clone()
        } else {
            right.clone()
        };
        Some((index, result))
    }

    fn logical(&mut self, operator: Operator, left: &Expression, right: &Expression) -> Type {
        self.value(left, Some(&Type::Bool));
        let skip = if crate::rules::SHORT_CIRCUIT {
            match operator {
                Operator::And => Some(self.emit(Op::JumpIfFalseKeep(0))),
                Operator::Or => Some(self.emit(Op::JumpIfTrueKeep(0))),
                _ => None,
            }
        } else {
            None
        };
        self.value(right, Some(&Type::Bool));
        self.emit(Op::Binary(match operator {
            Operator::And => BinaryOp::And,
            Operator::Or => BinaryOp::Or,
            _ => BinaryOp::Xor,
        }));
        if let Some(skip) = skip {
            self.patch_here(skip);
        }
        Type::Bool
    }

    fn call_value(&mut self, name: &Name, arguments: &[Argument], span: Span) -> Type {
        let key = name.key();
        if key == "present" {
            return self.present(arguments, span);
        }
        let Some(routine) = self.lookup_routine(name, true) else {
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        };
        let Some(result) = routine.signature.result.clone() else {
            self.error(Diagnostic::error(
                "RAPID0111",
                name.span,
                format!("{} is a procedure and has no value", name.text),
            ));
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        };
        let count = self.arguments(&routine.signature, name, arguments);
        match routine.callee {
            Callee::Routine(routine) => self.emit(Op::Call {
                routine,
                arguments: count,
            }),
            Callee::Builtin(builtin) => self.emit(Op::CallBuiltin {
                builtin,
                arguments: count,
                result: true,
            }),
            Callee::WaitUntil | Callee::ResetRetryCount | Callee::Trap(_) => 0,
        };
        result
    }

    fn present(&mut self, arguments: &[Argument], span: Span) -> Type {
        if let [
            Argument::Positional(Expression {
                kind: ExpressionKind::Name(name),
                ..
            }),
        ] = arguments
            && let Some(Symbol::Data(data)) = self.lookup(&name.to_lowercase()).cloned()
            && let (Slot::Local(slot), true) =
                (data.slot, matches!(data.access, Access::Parameter(_)))
        {
            if !data.optional {
                self.error(Diagnostic::warning(
                    "RAPID0125",
                    span,
                    format!("{name} is not optional, so it is always present"),
                ));
            }
            self.emit(Op::IsPresent(slot));
            return Type::Bool;
        }
        self.error(Diagnostic::error(
            "RAPID0126",
            span,
            "Present takes the name of an optional parameter of this routine",
        ));
        self.emit(Op::Push(Value::Bool(false)));
        Type::Bool
    }
}

pub(crate) use super::scope::Compiler;

/// Data, or components and elements of them.
pub(crate) fn is_place(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Name(_) => true,
        ExpressionKind::Field(inner, _) | ExpressionKind::Index(inner, _) => is_place(inner),
        _ => false,
    }
}

fn is_literal_number(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Number { .. } => true,
        ExpressionKind::Negate(inner) => is_literal_number(inner),
        ExpressionKind::Binary(operator, left, right) => {
            matches!(
                operator,
                Operator::Add | Operator::Subtract | Operator::Multiply | Operator::Divide
            ) && is_literal_number(left)
                && is_literal_number(right)
        }
        _ => false,
    }
}

fn operator_name(operator: Operator) -> &'static str {
    match operator {
        Operator::Add => "+",
        Operator::Subtract => "-",
        Operator::Multiply => "*",
        Operator::Divide => "/",
        Operator::Div => "DIV",
        Operator::Mod => "MOD",
        Operator::Equal => "=",
        Operator::NotEqual => "<>",
        Operator::Less => "<",
        Operator::LessOrEqual => "<=",
        Operator::Greater => ">",
        Operator::GreaterOrEqual => ">=",
        Operator::And => "AND",
        Operator::Or => "OR",
        Operator::Xor => "XOR",
    }
}
