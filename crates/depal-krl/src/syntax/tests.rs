use depal_syntax::Span;
use proptest::prelude::*;

use super::parser::parse;
use super::print::print;
use super::tree::*;

/// What is printed reads as the same tree, without a message.
#[track_caller]
fn check(file: &File) {
    let text = print(file);
    let mut diagnostics = Vec::new();
    let read = parse(0, &text, file.kind, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{diagnostics:?}\n{text}");
    assert_eq!(&read, file, "{text}");
}

fn name_of(text: &str) -> Name {
    Name {
        text: text.to_owned(),
        span: Span::default(),
    }
}

fn made(kind: ExpressionKind) -> Expression {
    Expression {
        kind,
        span: Span::default(),
    }
}

fn name() -> impl Strategy<Value = Name> {
    prop::sample::select(vec!["a", "B2", "reg1", "p_Über", "$VEL", "XP1", "e6"]).prop_map(name_of)
}

fn type_name() -> impl Strategy<Value = Name> {
    prop::sample::select(vec!["INT", "E6POS", "my_type", "Char"]).prop_map(name_of)
}

/// An operand, or anything in parentheses: the tree says where they stand.
fn grouped(expression: Expression) -> Expression {
    match expression.kind {
        ExpressionKind::Binary(..) | ExpressionKind::Negate(_) => {
            made(ExpressionKind::Group(Box::new(expression)))
        }
        ExpressionKind::Not(_) | ExpressionKind::BitNot(_) => {
            made(ExpressionKind::Group(Box::new(expression)))
        }
        _ => expression,
    }
}

fn target() -> impl Strategy<Value = Expression> + Clone {
    let leaf = name().prop_map(|n| made(ExpressionKind::Name(n.text)));
    leaf.prop_recursive(3, 6, 2, |inner| {
        let boxed = inner.prop_map(Box::new);
        let index = prop::option::of((0i64..99).prop_map(|i| made(ExpressionKind::Integer(i))));
        prop_oneof![
            (boxed.clone(), name()).prop_map(|(e, n)| ExpressionKind::Field(e, n)),
            (boxed, prop::collection::vec(index, 1..3))
                .prop_map(|(e, i)| ExpressionKind::Index(e, i)),
        ]
        .prop_map(made)
    })
}

fn expression() -> impl Strategy<Value = Expression> + Clone {
    let real = prop_oneof![any::<f64>(), (0i32..1000).prop_map(|v| f64::from(v) / 8.0)]
        .prop_filter("a number without a sign", |v| {
            v.is_finite() && v.is_sign_positive()
        });
    let leaf = prop_oneof![
        (0i64..=i64::from(i32::MAX)).prop_map(ExpressionKind::Integer),
        (i64::from(i32::MIN)..0).prop_map(ExpressionKind::Integer),
        real.prop_map(ExpressionKind::Real),
        "[ -!#-~é;]{0,12}".prop_map(ExpressionKind::Text),
        any::<bool>().prop_map(ExpressionKind::Bool),
        prop::sample::select(vec!["RED", "end", "C_DIS"])
            .prop_map(|n| ExpressionKind::Constant(name_of(n))),
        target().prop_map(|t| t.kind),
    ]
    .prop_map(made);
    leaf.prop_recursive(4, 24, 4, |inner| {
        let operand = inner.clone().prop_map(|e| Box::new(grouped(e)));
        let operators: Vec<_> = Operator::ALL
            .iter()
            .map(|(_, operator)| *operator)
            .collect();
        let field = (name(), any::<bool>(), inner.clone())
            .prop_map(|(name, whole, value)| AggregateField { name, whole, value });
        prop_oneof![
            (
                name(),
                prop::collection::vec(prop::option::of(inner.clone()), 2..4)
            )
                .prop_map(|(name, arguments)| ExpressionKind::Call { name, arguments }),
            (
                prop::option::of(type_name()),
                prop::collection::vec(field, 0..3)
            )
                .prop_map(|(type_name, fields)| ExpressionKind::Aggregate { type_name, fields }),
            inner
                .clone()
                .prop_map(|e| ExpressionKind::Group(Box::new(e))),
            operand.clone().prop_map(ExpressionKind::Negate),
            operand.clone().prop_map(ExpressionKind::Not),
            operand.clone().prop_map(ExpressionKind::BitNot),
            (prop::sample::select(operators), operand.clone(), operand)
                .prop_map(|(o, a, b)| ExpressionKind::Binary(o, a, b)),
        ]
        .prop_map(made)
    })
}

fn arguments() -> impl Strategy<Value = Arguments> {
    prop::collection::vec(expression().prop_map(Some), 0..3)
}

fn item(valued: bool) -> impl Strategy<Value = DataItem> {
    let sizes = prop::collection::vec(prop::option::of(expression()), 0..3);
    let value = prop::option::of(expression());
    (name(), sizes, value).prop_map(move |(name, sizes, value)| DataItem {
        name,
        sizes,
        value: value.filter(|_| valued),
    })
}

fn mode() -> impl Strategy<Value = Option<Mode>> {
    prop::sample::select(vec![None, Some(Mode::In), Some(Mode::Out)])
}

fn declaration() -> impl Strategy<Value = Declaration> {
    let items = |valued| prop::collection::vec(item(valued), 1..3);
    let field = (type_name(), item(false));
    let external = (type_name(), any::<bool>(), mode());
    prop_oneof![
        (any::<bool>(), any::<bool>(), type_name(), items(true)).prop_map(
            |(global, constant, type_name, items)| Declaration::Data {
                global,
                constant,
                type_name,
                items
            }
        ),
        (any::<bool>(), name(), prop::collection::vec(field, 1..3)).prop_map(
            |(global, name, fields)| Declaration::Struc {
                global,
                name,
                fields
            }
        ),
        (any::<bool>(), name(), prop::collection::vec(name(), 1..3)).prop_map(
            |(global, name, constants)| Declaration::Enum {
                global,
                name,
                constants
            }
        ),
        (any::<bool>(), name(), target(), prop::option::of(target())).prop_map(
            |(global, name, from, to)| Declaration::Signal {
                global,
                name,
                from,
                to
            }
        ),
        (
            prop::option::of(type_name()),
            name(),
            prop::collection::vec(external, 0..3)
        )
            .prop_map(|(result, name, parameters)| Declaration::External {
                result,
                name,
                parameters
            }),
    ]
}

fn movement() -> impl Strategy<Value = Move> {
    let words: Vec<_> = MoveWord::ALL.iter().map(|(_, word)| *word).collect();
    let words_of = prop::sample::select(vec!["C_PTP", "C_DIS", "C_VEL"]).prop_map(name_of);
    let frame = prop::sample::select(vec!["BASE", "TOOL"]).prop_map(name_of);
    (
        prop::sample::select(words),
        (expression(), expression(), prop::option::of(expression())),
        prop::collection::vec(words_of, 0..3),
        prop::option::of(frame),
        prop::collection::vec((target(), expression()), 0..2),
    )
        .prop_map(
            |(word, (first, second, angle), approximation, frame, with)| {
                let circular = word.is_circular();
                Move {
                    word,
                    points: if circular {
                        vec![first, second]
                    } else {
                        vec![first]
                    },
                    angle: angle.filter(|_| circular),
                    approximation,
                    frame,
                    with,
                }
            },
        )
}

fn simple() -> impl Strategy<Value = StatementKind> {
    let actions: Vec<_> = InterruptAction::ALL.iter().map(|(_, a)| *a).collect();
    let call = || {
        (name(), arguments()).prop_map(|(name, arguments)| StatementKind::Call { name, arguments })
    };
    let assign = || {
        (target(), expression()).prop_map(|(target, value)| StatementKind::Assign { target, value })
    };
    let place = prop_oneof![
        expression().prop_map(TriggerPlace::Distance),
        (expression(), any::<bool>())
            .prop_map(|(distance, on_start)| TriggerPlace::Path { distance, on_start }),
    ];
    prop_oneof![
        declaration().prop_map(StatementKind::Declare),
        assign(),
        call(),
        movement().prop_map(|m| StatementKind::Move(Box::new(m))),
        prop::sample::select(vec![
            StatementKind::Exit,
            StatementKind::Halt,
            StatementKind::Continue,
            StatementKind::Resume,
            StatementKind::Return(None),
            StatementKind::Brake { hard: true },
            StatementKind::Brake { hard: false },
        ]),
        name().prop_map(StatementKind::Goto),
        name().prop_map(StatementKind::Label),
        expression().prop_map(|e| StatementKind::Return(Some(e))),
        expression().prop_map(StatementKind::WaitFor),
        expression().prop_map(StatementKind::WaitSec),
        (
            any::<bool>(),
            expression(),
            expression(),
            name(),
            arguments()
        )
            .prop_map(|(global, number, condition, routine, arguments)| {
                StatementKind::InterruptDecl {
                    global,
                    number,
                    condition,
                    routine,
                    arguments,
                }
            }),
        (
            prop::sample::select(actions),
            prop::option::of(expression())
        )
            .prop_map(|(action, number)| StatementKind::Interrupt { action, number }),
        (
            place,
            expression(),
            prop_oneof![assign(), call()],
            prop::option::of(expression())
        )
            .prop_map(|(place, delay, action, priority)| StatementKind::Trigger {
                place,
                delay,
                action: Box::new(statement_of(action)),
                priority,
            }),
    ]
}

fn statement_of(kind: StatementKind) -> Statement {
    Statement {
        kind,
        span: Span::default(),
    }
}

fn statements() -> BoxedStrategy<Vec<Statement>> {
    let statement = simple().prop_recursive(3, 12, 3, |inner| {
        let block = || prop::collection::vec(inner.clone().prop_map(statement_of), 0..3);
        let values = prop::collection::vec(expression(), 1..3);
        let cases = prop::collection::vec((values, block()), 0..3);
        prop_oneof![
            (expression(), block(), prop::option::of(block())).prop_map(
                |(condition, body, otherwise)| StatementKind::If {
                    condition,
                    body,
                    otherwise
                }
            ),
            (
                target(),
                expression(),
                expression(),
                prop::option::of(expression()),
                block()
            )
                .prop_map(|(variable, from, to, step, body)| StatementKind::For {
                    variable,
                    from,
                    to,
                    step,
                    body
                }),
            (expression(), block())
                .prop_map(|(condition, body)| StatementKind::While { condition, body }),
            (block(), expression()).prop_map(|(body, until)| StatementKind::Repeat { body, until }),
            block().prop_map(StatementKind::Loop),
            (expression(), cases, prop::option::of(block())).prop_map(
                |(subject, cases, default)| StatementKind::Switch {
                    subject,
                    cases,
                    default
                }
            ),
        ]
    });
    prop::collection::vec(statement.prop_map(statement_of), 0..5).boxed()
}

fn routine() -> impl Strategy<Value = Routine> {
    let parameter = (name(), 0..4usize, mode()).prop_map(|(name, dimensions, mode)| Parameter {
        name,
        dimensions,
        mode,
    });
    (
        any::<bool>(),
        prop::option::of((type_name(), any::<bool>())),
        name(),
        prop::collection::vec(parameter, 0..3),
        statements(),
    )
        .prop_map(|(global, result, name, parameters, body)| Routine {
            global,
            result,
            name,
            parameters,
            body,
        })
}

fn file() -> impl Strategy<Value = File> {
    let list = (name(), any::<bool>(), statements());
    (
        prop::option::of(list),
        prop::collection::vec(routine(), 0..3),
    )
        .prop_map(|(list, routines)| {
            let (name, public, data) = match list {
                Some((name, public, data)) => (Some(name), public, data),
                None => (None, false, Vec::new()),
            };
            File {
                kind: FileKind::Source,
                name,
                public,
                data,
                routines,
            }
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_printed_reads_as_the_same_tree(file in file()) {
        check(&file);
    }
}

#[test]
fn headers_folds_and_comments_say_nothing() {
    let text = "&ACCESS RVP\r\n&PARAM X = 1\r\n;FOLD a;%{PE}\r\nDEF m( ) ; why\r\n  HALT;now\r\n;ENDFOLD\r\nEND\r\n";
    let mut diagnostics = Vec::new();
    let file = parse(0, text, FileKind::Source, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    assert_eq!(print(&file), "DEF m()\n  HALT\nEND\n");
}
