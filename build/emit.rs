//! [`Table`] -> Rust.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use crate::expr::{Expr, Function, Operations, Operator};
use crate::ir::{Kind, Table};

/// A module per table, and the list of what they say about themselves.
pub(crate) fn emit(tables: &[Table]) -> TokenStream {
    let modules = tables.iter().map(module);
    let names = tables.iter().map(|table| format_ident!("{}", table.name.replace('-', "_")));
    quote! {
        #(#modules)*
        /// What the tables say about themselves, in order of their names.
        pub const ALL: &[EffectTable] = &[#(#names::TABLE),*];
    }
}

fn module(table: &Table) -> TokenStream {
    let name = format_ident!("{}", table.name.replace('-', "_"));
    let doc = format!("Generated from `{}.toml`: {}.", table.name, table.description);
    let constant = description(table);
    let function = function(table);
    quote! {
        #[doc = #doc]
        pub mod #name {
            #[allow(unused_imports, reason = "a table needs Signals or Point, not both")]
            use super::{EffectTable, Operations, Kind, Point, Real, Signals};
            #constant
            #function
        }
    }
}

fn description(table: &Table) -> TokenStream {
    let Table { name, description, equation, source, sympy, unit, components, rows, columns, .. } = table;
    let kind = match table.kind {
        Kind::Rate => quote!(Some(Kind::Rate)),
        Kind::Force => quote!(Some(Kind::Force)),
        Kind::Sensors => quote!(Some(Kind::Sensors)),
        Kind::Measurement => quote!(Some(Kind::Measurement)),
        _ => quote!(None),
    };
    let inputs = table.inputs.iter().map(|(_, field)| field);
    let nonzeros = table.entries.len();
    let Operations { add, multiply, divide, function } = table.operations;
    let counted = quote!(Operations { add: #add, multiply: #multiply, divide: #divide, function: #function });
    quote! {
        /// What the table says about itself.
        pub const TABLE: EffectTable = EffectTable {
            name: #name,
            kind: #kind,
            description: #description,
            equation: #equation,
            source: #source,
            sympy: #sympy,
            unit: #unit,
            components: &[#(#components),*],
            inputs: &[#(#inputs),*],
            rows: #rows,
            columns: #columns,
            nonzeros: #nonzeros,
            operations: #counted,
        };
    }
}

fn function(table: &Table) -> TokenStream {
    let (name, doc) = match table.kind {
        Kind::Rate | Kind::Force | Kind::Sensors => {
            ("input_jacobian", "Calls `put(input, parameter, value)`.")
        }
        Kind::Measurement => ("measurement_jacobian", "Calls `put(channel, parameter, value)`."),
        Kind::Core => ("core_jacobian", "Calls `put(row, column, value)`."),
        Kind::Residual => ("measurement_jacobian", "Calls `put(channel, column, value)`."),
        Kind::Injection => ("inject", "Calls `put(row, value)` for one column times `value`."),
        Kind::ResidualInput => ("measure_input", "Calls `put(channel, value)` for one column times `value`."),
    };
    let name = format_ident!("{name}");
    let (from, argument) = if table.kind.of_signals() {
        (format_ident!("signals"), quote!(signals: &Signals<T>))
    } else {
        (format_ident!("at"), quote!(at: &Point<T>))
    };
    let from_ = if table.inputs.is_empty() { quote!(let _ = #from;) } else { quote!() };
    let constants = table.constants.iter().map(|(name, value)| {
        let name = format_ident!("{name}");
        quote!(let #name = T::of(#value);)
    });
    let steps = table.steps.iter().map(|(name, value)| {
        let (name, value) = (format_ident!("{name}"), expression(value));
        quote!(let #name = #value;)
    });
    let (arguments, body) = if table.kind.by_column() {
        (quote!(input: usize, value: T, put: &mut impl FnMut(usize, T)), columns(table, &quote!(#from)))
    } else {
        let inputs = inputs(table, &quote!(#from), |_| true);
        let entries = table.entries.iter().map(|e| {
            let (row, column, value) = (e.row, e.column, expression(&e.expr));
            quote!(put(#row, #column, #value);)
        });
        (
            quote!(put: &mut impl FnMut(usize, usize, T)),
            quote!(#inputs #(#constants)* #(#steps)* #(#entries)*),
        )
    };
    quote! {
        #[doc = #doc]
        #[inline(always)]
        pub fn #name<T: Real>(#argument, #arguments) {
            #from_
            #body
        }
    }
}

/// Reads the inputs that are wanted, and no others.
fn inputs(table: &Table, from: &TokenStream, wanted: impl Fn(&str) -> bool) -> TokenStream {
    let inputs = table.inputs.iter().filter(|(name, _)| wanted(name)).map(|(name, field)| {
        let name = format_ident!("{name}");
        let path = field.split('.').map(|part| format_ident!("{part}"));
        quote!(let #name = #from #(.#path)*;)
    });
    quote!(#(#inputs)*)
}

/// A match over the columns.
fn columns(table: &Table, from: &TokenStream) -> TokenStream {
    let arms = (0..table.columns).map(|column| {
        let entries: Vec<_> = table.entries.iter().filter(|e| e.column == column).collect();
        let mut used = std::collections::BTreeSet::new();
        entries.iter().for_each(|e| e.expr.names(&mut |name| used.extend([name.to_owned()])));
        let inputs = inputs(table, from, |name| used.contains(name));
        let puts = entries.iter().map(|e| {
            let (row, value) = (e.row, expression(&e.expr));
            quote!(put(#row, (#value) * value);)
        });
        quote!(#column => { #inputs #(#puts)* })
    });
    quote!(match input { #(#arms)* _ => {} })
}

fn expression(expr: &Expr) -> TokenStream {
    match expr {
        Expr::Number(value) => quote!(T::of(#value)),
        Expr::Name(name) => {
            let name = format_ident!("{name}");
            quote!(#name)
        }
        Expr::Negate(e) => {
            let e = operand(e);
            quote!(-#e)
        }
        Expr::Binary(operator, a, b) => {
            // Left to right, as it was parsed: only a right operand and sums in products need parentheses.
            let a = if joins(*operator, a) { expression(a) } else { operand(a) };
            let b = if is_product(b) && !is_product(expr) { expression(b) } else { operand(b) };
            match operator {
                Operator::Add => quote!(#a + #b),
                Operator::Subtract => quote!(#a - #b),
                Operator::Multiply => quote!(#a * #b),
                Operator::Divide => quote!(#a / #b),
            }
        }
        Expr::Power(base, exponent) => power(base, *exponent),
        Expr::Call(function, e) => {
            let e = operand(e);
            match function {
                Function::Sin => quote!(#e.sin()),
                Function::Cos => quote!(#e.cos()),
                Function::Tan => quote!(#e.tan()),
                Function::Sqrt => quote!(#e.sqrt()),
                Function::Abs => quote!(#e.abs()),
            }
        }
    }
}

fn is_product(expr: &Expr) -> bool {
    matches!(expr, Expr::Binary(Operator::Multiply | Operator::Divide, ..))
}

/// Whether a left operand needs no parentheses.
fn joins(operator: Operator, left: &Expr) -> bool {
    match operator {
        Operator::Add | Operator::Subtract => matches!(left, Expr::Binary(..) | Expr::Negate(_)),
        Operator::Multiply | Operator::Divide => is_product(left) || matches!(left, Expr::Negate(_)),
    }
}

/// An expression as an operand, in parentheses unless it is one token or a call.
fn operand(expr: &Expr) -> TokenStream {
    let tokens = expression(expr);
    match expr {
        Expr::Number(_) | Expr::Name(_) | Expr::Call(..) => tokens,
        _ => quote!((#tokens)),
    }
}

/// Repeated multiplication.
fn power(base: &Expr, exponent: i32) -> TokenStream {
    let repeated = |factor: &Ident| {
        let times = (1..exponent.unsigned_abs()).map(|_| quote!(* #factor));
        quote!(#factor #(#times)*)
    };
    let product = match base {
        Expr::Name(name) => repeated(&format_ident!("{name}")),
        _ => {
            let (value, product) = (expression(base), repeated(&format_ident!("base")));
            quote!({ let base = #value; #product })
        }
    };
    if exponent < 0 { quote!(T::of(1.0) / (#product)) } else { product }
}
