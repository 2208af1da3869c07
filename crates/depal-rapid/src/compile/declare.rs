use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use depal_vm::{
    CallParameter, Diagnostic, ErrorHandler, LanguageRules, Op, Program, Routine as Lowered,
    SourceFile, Span, Value,
};

use super::scope::*;
use super::types::{REFUSED_TYPES, RecordType, SignalKind, Type, simple_type};
use crate::builtins::Table;
use crate::errors;
use crate::syntax::tree::*;

/// Largest array that a program may declare, in elements.
const ARRAY_LIMIT: f64 = 1_000_000.0;

/// Checks the modules and lowers them. `modules[0]` holds the predefined data.
pub(crate) fn compile(
    files: &[SourceFile],
    modules: &[Module],
    signals: Option<BTreeMap<String, (String, SignalKind)>>,
    entry: Option<&str>,
    table: &Table,
) -> (Program, Vec<Diagnostic>) {
    let any_signal = signals.is_none();
    let compiler = run(
        files,
        modules,
        (signals.unwrap_or_default(), any_signal),
        entry,
        table,
    );
    (compiler.program, compiler.diagnostics)
}

/// Names that are used as signals and are not known, with the kind that their use asks for.
pub(crate) fn undefined_signals(
    files: &[SourceFile],
    modules: &[Module],
    signals: BTreeMap<String, (String, SignalKind)>,
    table: &Table,
) -> Vec<(String, SignalKind)> {
    let compiler = run(files, modules, (signals, true), None, table);
    compiler
        .taken_signals
        .into_values()
        .map(|(name, kind)| (name, kind.unwrap_or(SignalKind::Di)))
        .collect()
}

fn run<'a>(
    files: &[SourceFile],
    modules: &[Module],
    (signals, any_signal): (BTreeMap<String, (String, SignalKind)>, bool),
    entry: Option<&str>,
    table: &'a Table,
) -> Compiler<'a> {
    let line_starts = files
        .iter()
        .map(|file| {
            let newlines = file.text.bytes().enumerate();
            std::iter::once(0)
                .chain(
                    newlines
                        .filter(|(_, b)| *b == b'\n')
                        .map(|(i, _)| i as u32 + 1),
                )
                .collect()
        })
        .collect();
    let mut compiler = Compiler {
        diagnostics: Vec::new(),
        line_starts,
        records: Vec::new(),
        types: BTreeMap::new(),
        local_types: vec![BTreeMap::new(); modules.len()],
        predefined: Scope::new(),
        task: Scope::new(),
        module_scopes: vec![Scope::new(); modules.len()],
        module: 0,
        signals,
        any_signal,
        taken_signals: BTreeMap::new(),
        table,
        program: Program {
            builtins: table.builtins(),
            rules: LanguageRules {
                raise: crate::errors::raise,
                error_name: crate::errors::error_name,
                string_limit: 80,
                retry_limit: 4,
                recursion_limit: 200,
            },
            ..Program::default()
        },
        body: Body::default(),
    };
    compiler.records(modules);
    compiler.builtins();
    let data = compiler.module_data(modules);
    let routines = compiler.headings(modules);
    compiler.initial_values(&data);
    for (module, routine, index) in routines {
        compiler.module = module;
        compiler.routine(routine, index, &modules[module].name.text);
    }
    if let Some(entry) = entry {
        compiler.entry(entry);
    }
    compiler
}

/// Module data with what is needed to compute their initial values.
struct Declared<'x> {
    module: usize,
    data: &'x Data,
    slot: u32,
    kind: Type,
}

/// Which initial values are computed, and which have been begun.
#[derive(Default)]
struct Progress {
    done: BTreeSet<usize>,
    open: BTreeSet<usize>,
}

impl Compiler<'_> {
    fn records(&mut self, modules: &[Module]) {
        let mut declared = Vec::new();
        for (module, tree) in modules.iter().enumerate() {
            for record in &tree.records {
                let index = self.records.len();
                self.records.push(RecordType {
                    name: record.name.text.clone(),
                    fields: Vec::new(),
                });
                declared.push((module, record));
                let scope = if record.local {
                    &mut self.local_types[module]
                } else {
                    &mut self.types
                };
                let known = simple_type(&record.name.key()).is_some()
                    || scope.contains_key(&record.name.key());
                scope.insert(record.name.key(), Type::Record(index));
                if known {
                    self.error(Diagnostic::error(
                        "RAPID0110",
                        record.name.span,
                        format!("the type {} is declared twice", record.name.text),
                    ));
                }
            }
        }
        for (module, tree) in modules.iter().enumerate() {
            self.module = module;
            for (known, name) in &tree.aliases {
                let kind = self.resolve_type(known);
                self.types.insert(name.key(), kind);
            }
        }
        for (index, (module, record)) in declared.iter().enumerate() {
            self.module = *module;
            for (kind, name) in &record.fields {
                let resolved = self.resolve_type(kind);
                // Only records declared before may be components, so that no record holds itself.
                let resolved = match resolved {
                    Type::Record(inner) if inner >= index => {
                        self.error(Diagnostic::error(
                            "RAPID0132",
                            kind.span,
                            format!("{} must be declared before it is a component", kind.text),
                        ));
                        Type::Broken
                    }
                    other => other,
                };
                self.records[index]
                    .fields
                    .push((name.text.clone(), resolved));
            }
        }
    }

    fn resolve_type(&mut self, name: &Name) -> Type {
        let key = name.key();
        if let Some(kind) = self.lookup_type(&key) {
            return kind;
        }
        if REFUSED_TYPES.contains(&key.as_str()) {
            self.error(Diagnostic::error(
                "RAPID0112",
                name.span,
                format!("the type {} is not simulated", name.text),
            ));
            return Type::Broken;
        }
        const SIMPLE: [&str; 13] = [
            "num",
            "dnum",
            "bool",
            "string",
            "rawbytes",
            "socketdev",
            "clock",
            "switch",
            "errnum",
            "signaldi",
            "signaldo",
            "signalgi",
            "signalgo",
        ];
        let names = SIMPLE
            .iter()
            .map(|s| (*s).to_owned())
            .chain(self.records.iter().map(|r| r.name.clone()));
        let mut diagnostic = Diagnostic::error(
            "RAPID0103",
            name.span,
            format!("there is no type named {}", name.text),
        );
        if let Some(near) = nearest_name(&name.text, names) {
            diagnostic = diagnostic.help(format!("did you mean {near}?"));
        }
        self.error(diagnostic);
        Type::Broken
    }

    fn signature(&mut self, routine: &Routine) -> Signature {
        let parameters = routine
            .parameters
            .iter()
            .map(|parameter| {
                let element = self.resolve_type(&parameter.type_name);
                let kind = if parameter.dimensions == 0 {
                    element
                } else {
                    Type::Array {
                        element: Box::new(element),
                        sizes: vec![0; parameter.dimensions],
                    }
                };
                ParameterType {
                    name: parameter.name.text.clone(),
                    key: parameter.name.key(),
                    kind,
                    mode: parameter.mode,
                    optional: parameter.optional,
                    group: parameter.group,
                }
            })
            .collect();
        let result = match &routine.kind {
            RoutineKind::Function(kind) => Some(self.resolve_type(kind)),
            _ => None,
        };
        Signature {
            name: routine.name.text.clone(),
            parameters,
            result,
        }
    }

    fn builtins(&mut self) {
        self.module = 0;
        for (heading, callee) in self.table.headings() {
            let signature = Rc::new(self.signature(heading));
            let symbol = Symbol::Routine(RoutineSymbol {
                signature,
                callee,
                span: Span::new(u32::MAX, 0, 0),
            });
            self.predefined.insert(heading.name.key(), symbol);
        }
    }

    fn declare(&mut self, module: usize, local: bool, name: &Name, symbol: Symbol) {
        let scope = if module == 0 {
            &mut self.predefined
        } else if local {
            &mut self.module_scopes[module]
        } else {
            &mut self.task
        };
        if let Some(first) = scope.get(&name.key()) {
            let first = first.span();
            self.error(
                Diagnostic::error(
                    "RAPID0110",
                    name.span,
                    format!("{} is declared twice", name.text),
                )
                .secondary(first, "first declared here"),
            );
            return;
        }
        scope.insert(name.key(), symbol);
    }

    fn module_data<'x>(&mut self, modules: &'x [Module]) -> Vec<Declared<'x>> {
        let mut declared = Vec::new();
        // Names first, so that sizes and values may use what is declared later.
        for (module, tree) in modules.iter().enumerate() {
            self.module = module;
            for data in &tree.data {
                let kind = self.resolve_type(&data.type_name);
                let slot = self.program.globals.len() as u32;
                self.program.globals.push(Value::Absent);
                self.program.global_names.push(data.name.text.clone());
                let symbol = Symbol::Data(DataSymbol {
                    name: data.name.text.clone(),
                    slot: Slot::Global(slot),
                    kind: kind.clone(),
                    access: Access::Stored(data.storage),
                    optional: false,
                    span: data.name.span,
                    constant: constant_of(data),
                });
                self.declare(module, data.local, &data.name, symbol);
                declared.push(Declared {
                    module,
                    data,
                    slot,
                    kind,
                });
            }
        }
        for item in &mut declared {
            self.module = item.module;
            item.kind = self.array_type(item.kind.clone(), item.data);
            let kind = item.kind.clone();
            let scope = if item.module == 0 {
                &mut self.predefined
            } else if item.data.local {
                &mut self.module_scopes[item.module]
            } else {
                &mut self.task
            };
            if let Some(Symbol::Data(symbol)) = scope.get_mut(&item.data.name.key())
                && symbol.slot == Slot::Global(item.slot)
            {
                symbol.kind = kind.clone();
            }
            self.program.globals[item.slot as usize] = kind.default_value(&self.records);
        }
        declared
    }

    fn array_type(&mut self, element: Type, data: &Data) -> Type {
        if data.sizes.is_empty() {
            return element;
        }
        if data.sizes.len() > 3 {
            let span = data.name.span;
            self.error(Diagnostic::error(
                "RAPID0114",
                span,
                "an array has at most 3 dimensions",
            ));
            return Type::Broken;
        }
        let mut sizes = Vec::new();
        let mut total = 1.0;
        for size in &data.sizes {
            let value = self.constant(size, 0);
            total *= value.unwrap_or(1.0);
            match value {
                Some(value) if value >= 1.0 && value.fract() == 0.0 && total <= ARRAY_LIMIT => {
                    sizes.push(value as usize);
                }
                Some(value) => {
                    self.error(Diagnostic::error(
                        "RAPID0114",
                        size.span,
                        format!("{value} cannot be the size of an array"),
                    ));
                    return Type::Broken;
                }
                None => {
                    self.error(Diagnostic::error(
                        "RAPID0116",
                        size.span,
                        "the size of an array is a number or a constant",
                    ));
                    return Type::Broken;
                }
            }
        }
        Type::Array {
            element: Box::new(element),
            sizes,
        }
    }

    /// Value of a constant expression of numbers.
    fn constant(&self, expression: &Expression, depth: usize) -> Option<f64> {
        if depth > 32 {
            return None;
        }
        match &expression.kind {
            ExpressionKind::Number { value, .. } => Some(*value),
            ExpressionKind::Negate(inner) => Some(-self.constant(inner, depth + 1)?),
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()) {
                Some(Symbol::Data(data)) => {
                    let value = data.constant.clone()?;
                    self.constant(&value, depth + 1)
                }
                Some(Symbol::Routine(_)) => None,
                None => crate::errors::ERRORS
                    .iter()
                    .find(|(error, _)| error.eq_ignore_ascii_case(name))
                    .map(|(_, number)| *number as f64),
            },
            ExpressionKind::Binary(operator, left, right) => {
                let (a, b) = (
                    self.constant(left, depth + 1)?,
                    self.constant(right, depth + 1)?,
                );
                match operator {
                    Operator::Add => Some(a + b),
                    Operator::Subtract => Some(a - b),
                    Operator::Multiply => Some(a * b),
                    Operator::Divide if b != 0.0 => Some(a / b),
                    Operator::Div if b != 0.0 => Some((a / b).trunc()),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn headings<'x>(&mut self, modules: &'x [Module]) -> Vec<(usize, &'x Routine, u32)> {
        let mut routines = Vec::new();
        let mut names: BTreeMap<String, Span> = BTreeMap::new();
        for (module, tree) in modules.iter().enumerate() {
            self.module = module;
            if let Some(first) = names.insert(tree.name.key(), tree.name.span) {
                self.error(
                    Diagnostic::error(
                        "RAPID0110",
                        tree.name.span,
                        format!("there are two modules named {}", tree.name.text),
                    )
                    .secondary(first, "the first"),
                );
            }
            for routine in &tree.routines {
                let index = self.program.routines.len() as u32;
                self.program.routines.push(Lowered::default());
                let signature = Rc::new(self.signature(routine));
                let symbol = Symbol::Routine(RoutineSymbol {
                    signature,
                    callee: match routine.kind {
                        RoutineKind::Trap => Callee::Trap(index),
                        _ => Callee::Routine(index),
                    },
                    span: routine.name.span,
                });
                self.declare(module, routine.local, &routine.name, symbol);
                routines.push((module, routine, index));
            }
        }
        routines
    }

    /// Initial values in an order in which each is there before it is used.
    fn initial_values(&mut self, declared: &[Declared<'_>]) {
        self.body = Body::default();
        let by_slot: BTreeMap<u32, usize> = declared
            .iter()
            .enumerate()
            .map(|(i, d)| (d.slot, i))
            .collect();
        let mut progress = Progress::default();
        for index in 0..declared.len() {
            self.initial_value(declared, &by_slot, index, &mut progress, 0);
        }
        self.emit(Op::Return { value: false });
        let body = std::mem::take(&mut self.body);
        if body.code.len() > 1 {
            self.program.initializer = Some(self.program.routines.len() as u32);
            self.program.routines.push(Lowered {
                name: "(initial values)".into(),
                module: String::new(),
                line: 1,
                locals: body.locals,
                code: body.code,
                ..Lowered::default()
            });
        }
    }

    fn initial_value(
        &mut self,
        declared: &[Declared<'_>],
        by_slot: &BTreeMap<u32, usize>,
        index: usize,
        progress: &mut Progress,
        depth: usize,
    ) {
        let item = &declared[index];
        if progress.done.contains(&index) {
            return;
        }
        if depth > 100 || !progress.open.insert(index) {
            self.error(Diagnostic::error(
                "RAPID0135",
                item.data.name.span,
                format!(
                    "the value of {} depends on itself, or on more than 100 others in a chain",
                    item.data.name.text
                ),
            ));
            return;
        }
        let Some(value) = &item.data.value else {
            progress.done.insert(index);
            if item.data.storage == Storage::Const {
                self.error(Diagnostic::error(
                    "RAPID0133",
                    item.data.name.span,
                    format!("the constant {} has no value", item.data.name.text),
                ));
            }
            return;
        };
        self.module = item.module;
        let mut names = Vec::new();
        names_in(value, &mut names);
        for name in names {
            if let Some(Symbol::Data(data)) = self.lookup(&name)
                && let Slot::Global(slot) = data.slot
            {
                self.initial_value(declared, by_slot, by_slot[&slot], progress, depth + 1);
            }
        }
        self.module = item.module;
        progress.done.insert(index);
        let begin = self.body.code.len();
        self.value(value, Some(&item.kind));
        if let [Op::Push(constant)] = &self.body.code[begin..] {
            if constant.is_present() {
                self.program.globals[item.slot as usize] = constant.clone();
            }
            self.body.code.truncate(begin);
        } else {
            self.emit(Op::StoreGlobal(item.slot));
        }
    }

    fn routine(&mut self, routine: &Routine, index: u32, module_name: &str) {
        let signature = self.signature_of(routine);
        self.body = Body {
            result: signature.result.clone(),
            ..Body::default()
        };
        for (parameter, tree) in signature.parameters.iter().zip(&routine.parameters) {
            let slot = self.new_local(Value::Absent);
            self.declare_local(
                &tree.name,
                DataSymbol {
                    name: tree.name.text.clone(),
                    slot: Slot::Local(slot),
                    kind: parameter.kind.clone(),
                    access: Access::Parameter(parameter.mode),
                    optional: parameter.optional,
                    span: tree.name.span,
                    constant: None,
                },
            );
        }
        for data in &routine.data {
            self.local_data(data);
        }
        self.statements(&routine.body);
        if signature.result.is_some() {
            self.emit(Op::MissingReturn);
        } else {
            self.emit(Op::Return { value: false });
        }
        let handler = routine.handler.as_ref().map(|handler| {
            let entry = self.here();
            self.body.in_handler = true;
            self.statements(&handler.body);
            self.emit(Op::Reraise);
            let numbers = handler.numbers.as_ref().map(|numbers| {
                numbers
                    .iter()
                    .filter_map(|number| {
                        let value = self.constant(number, 0);
                        if value.is_none() {
                            self.error(Diagnostic::error(
                                "RAPID0116",
                                number.span,
                                "an error number in ERROR(..) is a number or a constant",
                            ));
                        }
                        value.map(|v| v as i64)
                    })
                    .collect()
            });
            let numbers: Option<Vec<i64>> = numbers;
            let all = errors::error("LONG_JMP_ALL_ERR", "").number;
            ErrorHandler {
                entry,
                numbers: numbers.filter(|numbers| !numbers.contains(&all)),
            }
        });
        self.body.in_handler = false;
        let undo = routine.undo.as_ref().map(|body| {
            let entry = self.here();
            self.statements(body);
            self.emit(Op::EndUndo);
            entry
        });
        if let Some(body) = &routine.backward {
            // Checked like the rest; nothing jumps here.
            self.statements(body);
            self.emit(Op::Return { value: false });
        }
        let callable = (routine.kind == RoutineKind::Procedure).then(|| {
            let parameter = |p: &ParameterType| CallParameter {
                by_reference: p.mode != Mode::Value,
                optional: p.optional,
            };
            signature.parameters.iter().map(parameter).collect()
        });
        self.resolve_gotos();
        let body = std::mem::take(&mut self.body);
        self.program.routines[index as usize] = Lowered {
            name: routine.name.text.clone(),
            module: module_name.to_owned(),
            line: self.line(routine.name.span),
            locals: body.locals,
            code: body.code,
            handler,
            undo,
            callable,
        };
    }

    /// The signature made with the headings; its errors were reported then.
    fn signature_of(&mut self, routine: &Routine) -> Rc<Signature> {
        let found = self.module_scopes[self.module]
            .get(&routine.name.key())
            .or_else(|| self.task.get(&routine.name.key()));
        if let Some(Symbol::Routine(symbol)) = found
            && symbol.span == routine.name.span
        {
            return Rc::clone(&symbol.signature);
        }
        let reported = self.diagnostics.len();
        let signature = self.signature(routine);
        self.diagnostics.truncate(reported);
        Rc::new(signature)
    }

    fn declare_local(&mut self, name: &Name, data: DataSymbol) {
        let previous = self.body.scope.insert(name.key(), Symbol::Data(data));
        if let Some(first) = previous {
            self.error(
                Diagnostic::error(
                    "RAPID0110",
                    name.span,
                    format!("{} is declared twice", name.text),
                )
                .secondary(first.span(), "first declared here"),
            );
        }
    }

    fn local_data(&mut self, data: &Data) {
        let element = self.resolve_type(&data.type_name);
        let kind = self.array_type(element, data);
        if data.storage == Storage::Pers {
            self.error(
                Diagnostic::error(
                    "RAPID0134",
                    data.name.span,
                    format!("PERS {} cannot be declared in a routine", data.name.text),
                )
                .help("move it to the module"),
            );
        }
        let slot = self.new_local(kind.default_value(&self.records));
        if let Some(value) = &data.value {
            let begin = self.body.code.len();
            self.value(value, Some(&kind));
            if let [Op::Push(constant)] = &self.body.code[begin..] {
                if constant.is_present() {
                    self.body.locals[slot as usize] = constant.clone();
                }
                self.body.code.truncate(begin);
            } else {
                self.emit(Op::SetLocal(slot));
            }
        }
        self.declare_local(
            &data.name,
            DataSymbol {
                name: data.name.text.clone(),
                slot: Slot::Local(slot),
                kind,
                access: Access::Stored(data.storage),
                optional: false,
                span: data.name.span,
                constant: constant_of(data),
            },
        );
    }

    fn entry(&mut self, entry: &str) {
        self.module = self.module_scopes.len();
        match self.task.get(&entry.to_lowercase()) {
            Some(Symbol::Routine(RoutineSymbol {
                callee: Callee::Routine(index),
                signature,
                ..
            })) if signature.result.is_none()
                && signature.parameters.iter().all(|p| p.optional) =>
            {
                self.program.entry = *index;
            }
            Some(other) => {
                let span = other.span();
                self.error(Diagnostic::error(
                    "RAPID0117",
                    span,
                    format!(
                        "{entry} cannot be started: it must be a PROC without required parameters"
                    ),
                ));
            }
            None => {
                let names = self.task.values().filter_map(|symbol| match symbol {
                    Symbol::Routine(routine) => Some(routine.signature.name.clone()),
                    Symbol::Data(_) => None,
                });
                let near = nearest_name(entry, names);
                let mut diagnostic = Diagnostic::error(
                    "RAPID0117",
                    Span::new(0, 0, 0),
                    format!("there is no procedure {entry} to start"),
                );
                if let Some(near) = near {
                    diagnostic = diagnostic.help(format!("did you mean {near}?"));
                }
                self.error(diagnostic);
            }
        }
    }
}

fn constant_of(data: &Data) -> Option<Rc<Expression>> {
    match (data.storage, &data.value) {
        (Storage::Const, Some(value)) if data.sizes.is_empty() => Some(Rc::new(value.clone())),
        _ => None,
    }
}

/// Keys of all names that an expression uses.
fn names_in(expression: &Expression, names: &mut Vec<String>) {
    match &expression.kind {
        ExpressionKind::Name(name) => names.push(name.to_lowercase()),
        ExpressionKind::Field(inner, _)
        | ExpressionKind::Negate(inner)
        | ExpressionKind::Not(inner) => names_in(inner, names),
        ExpressionKind::Index(inner, indexes) => {
            names_in(inner, names);
            for index in indexes {
                names_in(index, names);
            }
        }
        ExpressionKind::Call { arguments, .. } => {
            for argument in arguments {
                match argument {
                    Argument::Positional(value)
                    | Argument::Named {
                        value: Some(value), ..
                    } => names_in(value, names),
                    _ => {}
                }
            }
        }
        ExpressionKind::Aggregate(items) => {
            for item in items {
                names_in(item, names);
            }
        }
        ExpressionKind::Binary(_, left, right) => {
            names_in(left, names);
            names_in(right, names);
        }
        _ => {}
    }
}
