//! ABB RAPID: lexer, parser, checks, lowering and built-ins.
