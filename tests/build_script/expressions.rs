//! Expressions: values, precedence, costs, mistakes.

use crate::expr::{Expr, Function, Operations, Operator};

/// The value of an expression, with names standing for numbers.
fn value(expr: &Expr, names: &[(&str, f64)]) -> f64 {
    let of = |e| value(e, names);
    match expr {
        Expr::Number(n) => *n,
        Expr::Name(name) => names.iter().find(|(n, _)| n == name).unwrap().1,
        Expr::Negate(e) => -of(e),
        Expr::Binary(Operator::Add, a, b) => of(a) + of(b),
        Expr::Binary(Operator::Subtract, a, b) => of(a) - of(b),
        Expr::Binary(Operator::Multiply, a, b) => of(a) * of(b),
        Expr::Binary(Operator::Divide, a, b) => of(a) / of(b),
        Expr::Power(e, n) => of(e).powi(*n),
        Expr::Call(Function::Sin, e) => of(e).sin(),
        Expr::Call(Function::Cos, e) => of(e).cos(),
        Expr::Call(Function::Tan, e) => of(e).tan(),
        Expr::Call(Function::Sqrt, e) => of(e).sqrt(),
        Expr::Call(Function::Abs, e) => of(e).abs(),
    }
}

#[test]
fn precedence_is_python_s() {
    let names = [("a", 3.0), ("b_1", 5.0), ("x0", -2.0)];
    for (text, expected) in [
        ("1 - 2 - 3", -4.0),
        ("12/2/3", 2.0),
        ("12/(2*3)", 2.0),
        ("12/2*3", 18.0),
        ("1 + 2*3", 7.0),
        ("-a**2", -9.0),
        ("(-a)**2", 9.0),
        ("a**(-2)", 1.0 / 9.0),
        ("a**-1", 1.0 / 3.0),
        ("2*a**2/b_1", 3.6),
        ("a - -x0", 1.0),
        ("-a*b_1", -15.0),
        ("a*-b_1", -15.0),
        ("1.5e-3*2E+3", 3.0),
        (".5 + 1.", 1.5),
        ("sqrt(a + 1)*Abs(x0)", 4.0),
        ("sin(0) + cos(0) + tan(0)", 1.0),
        ("  ( a )  ", 3.0),
    ] {
        let expr = Expr::parse(text).unwrap_or_else(|e| panic!("{text}: {e:?}"));
        assert!((value(&expr, &names) - expected).abs() < 1e-15, "{text}: {expr:?}");
    }
}

#[test]
fn costs_are_counted_as_the_derivation_counts_them() {
    for (text, add, multiply, divide, function) in [
        ("-a", 0, 0, 0, 0),
        ("a - b", 1, 0, 0, 0),
        ("-a*b/c", 0, 1, 1, 0),
        ("a**4", 0, 3, 0, 0),
        ("a**(-2)", 0, 1, 1, 0),
        ("1/a**2", 0, 1, 1, 0),
        ("sin(a + b)*(c - 1)**2", 2, 2, 0, 1),
    ] {
        let mut counted = Operations::default();
        Expr::parse(text).unwrap().count(&mut counted);
        assert_eq!(counted, Operations { add, multiply, divide, function }, "{text}");
    }
}

#[test]
fn names_are_found() {
    let mut names = Vec::new();
    Expr::parse("a*sin(b) - c**2/(-d) + 1e3").unwrap().names(&mut |name| names.push(name.to_owned()));
    assert_eq!(names, ["a", "b", "c", "d"]);
}

#[test]
fn mistakes_are_placed() {
    for (text, at, message) in [
        ("", 0, "ends too early"),
        ("a +", 3, "ends too early"),
        ("a b", 2, "expected an operator, found `b`"),
        ("(a", 2, "expected `)`"),
        ("a)", 1, "found `)`"),
        ("a $ b", 2, "found `$`"),
        ("2*é", 2, "found `é`"),
        ("exp(a)", 0, "`exp` is not one of the functions"),
        ("a**b", 3, "integer exponent"),
        ("a**0", 3, "integer exponent"),
        ("a**1.5", 3, "integer exponent"),
        ("a**(1/2)", 3, "integer exponent"),
        ("a**99999999999", 3, "integer exponent"),
        ("1.2.3", 0, "`1.2.3` is not a number"),
        ("1e999", 0, "not a number"),
        ("1e", 0, "not a number"),
        (".", 0, "not a number"),
    ] {
        let problem = Expr::parse(text).expect_err(text);
        assert_eq!(problem.at, at, "{text}: {problem:?}");
        assert!(problem.message.contains(message), "{text}: {problem:?}");
    }
    for nested in ["(".repeat(10_000), "-".repeat(10_000), "sin(".repeat(10_000)] {
        assert!(Expr::parse(&nested).is_err());
    }
}
