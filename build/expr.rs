//! Expressions of the tables: numbers, names, `+ - * /`, `**` with an integer exponent, a sign, four
//! functions and `Abs`. Precedence as in Python, which writes them.

use std::fmt;

/// An arithmetic expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expr {
    /// A number, not negative.
    Number(f64),
    /// An input, constant or step.
    Name(String),
    /// Minus an expression.
    Negate(Box<Expr>),
    /// Two expressions and what joins them.
    Binary(Operator, Box<Expr>, Box<Expr>),
    /// An expression to an integer power.
    Power(Box<Expr>, i32),
    /// A function of an expression.
    Call(Function, Box<Expr>),
}

/// What joins two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
}

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    /// `sin`
    Sin,
    /// `cos`
    Cos,
    /// `tan`
    Tan,
    /// `sqrt`
    Sqrt,
    /// `Abs`
    Abs,
}

/// What an expression costs. A difference is an addition, `x**n` is n - 1 multiplications, a negative power
/// one division more, a change of sign nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Operations {
    /// Additions and subtractions.
    pub(crate) add: u32,
    /// Multiplications.
    pub(crate) multiply: u32,
    /// Divisions.
    pub(crate) divide: u32,
    /// Calls of functions.
    pub(crate) function: u32,
}

impl fmt::Display for Operations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { add, multiply, divide, function } = self;
        write!(f, "{add} additions, {multiply} multiplications, {divide} divisions, {function} functions")
    }
}

/// What is wrong with an expression, and at which byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Problem {
    /// Offset in the expression's text.
    pub(crate) at: usize,
    /// What was expected.
    pub(crate) message: String,
}

impl Expr {
    /// Reads an expression.
    pub(crate) fn parse(text: &str) -> Result<Self, Problem> {
        let mut parser = Parser { text, at: 0, depth: 0 };
        let expr = parser.sum()?;
        match parser.peek() {
            None => Ok(expr),
            Some(c) => Err(parser.problem(format!("expected an operator, found `{c}`"))),
        }
    }

    /// Calls `visit` with every name in the expression.
    pub(crate) fn names(&self, visit: &mut impl FnMut(&str)) {
        match self {
            Self::Number(_) => {}
            Self::Name(name) => visit(name),
            Self::Negate(e) | Self::Power(e, _) | Self::Call(_, e) => e.names(visit),
            Self::Binary(_, a, b) => {
                a.names(visit);
                b.names(visit);
            }
        }
    }

    /// Adds what the expression costs.
    pub(crate) fn count(&self, operations: &mut Operations) {
        match self {
            Self::Number(_) | Self::Name(_) => {}
            Self::Negate(e) => e.count(operations),
            Self::Binary(operator, a, b) => {
                match operator {
                    Operator::Add | Operator::Subtract => operations.add += 1,
                    Operator::Multiply => operations.multiply += 1,
                    Operator::Divide => operations.divide += 1,
                }
                a.count(operations);
                b.count(operations);
            }
            Self::Power(e, exponent) => {
                operations.multiply += exponent.unsigned_abs() - 1;
                operations.divide += u32::from(*exponent < 0);
                e.count(operations);
            }
            Self::Call(_, e) => {
                operations.function += 1;
                e.count(operations);
            }
        }
    }
}

const MAX_DEPTH: usize = 64;
const MAX_EXPONENT: i32 = 16;

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl Parser<'_> {
    fn problem(&self, message: impl Into<String>) -> Problem {
        Problem { at: self.at, message: message.into() }
    }

    /// The next character that is not white space.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn eat(&mut self, token: &str) -> bool {
        self.peek();
        let found = self.text[self.at..].starts_with(token);
        if found {
            self.at += token.len();
        }
        found
    }

    fn sum(&mut self) -> Result<Expr, Problem> {
        let mut left = self.product()?;
        loop {
            let operator = match self.peek() {
                Some('+') => Operator::Add,
                Some('-') => Operator::Subtract,
                _ => return Ok(left),
            };
            self.at += 1;
            left = Expr::Binary(operator, Box::new(left), Box::new(self.product()?));
        }
    }

    fn product(&mut self) -> Result<Expr, Problem> {
        let mut left = self.signed()?;
        loop {
            let operator = match self.peek() {
                Some('*') => Operator::Multiply,
                Some('/') => Operator::Divide,
                _ => return Ok(left),
            };
            self.at += 1;
            left = Expr::Binary(operator, Box::new(left), Box::new(self.signed()?));
        }
    }

    fn signed(&mut self) -> Result<Expr, Problem> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.problem("the expression is nested too deeply"));
        }
        let expr = if self.eat("-") { Expr::Negate(Box::new(self.signed()?)) } else { self.power()? };
        self.depth -= 1;
        Ok(expr)
    }

    fn power(&mut self) -> Result<Expr, Problem> {
        let base = self.atom()?;
        if !self.eat("**") {
            return Ok(base);
        }
        let exponent = self.exponent()?;
        Ok(Expr::Power(Box::new(base), exponent))
    }

    fn exponent(&mut self) -> Result<i32, Problem> {
        self.peek();
        let start = self.at;
        let wanted = || Problem {
            at: start,
            message: format!("expected an integer exponent other than 0, at most {MAX_EXPONENT} in size"),
        };
        let enclosed = self.eat("(");
        let negative = self.eat("-");
        self.peek();
        let digits: String = self.text[self.at..].chars().take_while(char::is_ascii_digit).collect();
        self.at += digits.len();
        let next = self.text[self.at..].chars().next();
        let size: i32 = digits.parse().map_err(|_| wanted())?;
        if size == 0 || size > MAX_EXPONENT || matches!(next, Some('.' | 'e')) {
            return Err(wanted());
        }
        if enclosed && !self.eat(")") {
            return Err(wanted());
        }
        Ok(if negative { -size } else { size })
    }

    fn atom(&mut self) -> Result<Expr, Problem> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.enclosed()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() || c == '_' => self.name(),
            Some(c) => Err(self.problem(format!("expected a number, a name or `(`, found `{c}`"))),
            None => Err(self.problem("the expression ends too early")),
        }
    }

    fn enclosed(&mut self) -> Result<Expr, Problem> {
        let expr = self.sum()?;
        if self.eat(")") { Ok(expr) } else { Err(self.problem("expected `)`")) }
    }

    fn number(&mut self) -> Result<Expr, Problem> {
        let bytes = self.text.as_bytes();
        let mut end = self.at;
        while end < bytes.len() {
            let sign = matches!(bytes[end], b'+' | b'-') && matches!(bytes[end - 1], b'e' | b'E');
            if !(bytes[end].is_ascii_digit()
                || matches!(bytes[end], b'.' | b'e' | b'E')
                || sign && end > self.at)
            {
                break;
            }
            end += 1;
        }
        let text = &self.text[self.at..end];
        let value = text.parse().ok().filter(|v: &f64| v.is_finite());
        let value = value.ok_or_else(|| self.problem(format!("`{text}` is not a number")))?;
        self.at = end;
        Ok(Expr::Number(value))
    }

    fn name(&mut self) -> Result<Expr, Problem> {
        let rest = &self.text[self.at..];
        let len = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let name = &rest[..len];
        let start = self.at;
        self.at += len;
        if self.peek() != Some('(') {
            return Ok(Expr::Name(name.to_owned()));
        }
        let function = match name {
            "sin" => Function::Sin,
            "cos" => Function::Cos,
            "tan" => Function::Tan,
            "sqrt" => Function::Sqrt,
            "Abs" => Function::Abs,
            _ => {
                let message = format!("`{name}` is not one of the functions sin, cos, tan, sqrt, Abs");
                return Err(Problem { at: start, message });
            }
        };
        self.at += 1;
        Ok(Expr::Call(function, Box::new(self.enclosed()?)))
    }
}
