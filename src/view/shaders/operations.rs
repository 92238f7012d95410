//! Programs that count what they execute: arithmetic operations, where `spirv_instructions` counts a program's text.
//!
//! Unlike its time on a software adapter, the count of a pixel leaves out sides of branches that it does not take, and rounds of
//! loops that only its neighbours need.

use crate::translate::CAPABILITIES;
use naga::valid::{FunctionInfo, ValidationFlags, Validator};
use naga::{
    Arena, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, MathFunction, Module, Range,
    ScalarKind, Span, Statement, TypeInner, UnaryOperator,
};

/// The variable that counts, of bind_loads.wgsl.
const COUNTER: &str = "bound_operations";

/// What a division, a root, an exponential or the like counts as: GPUs have a unit for it a quarter as wide.
const SPECIAL: u32 = 4;

/// A program, given as WGSL, that adds to `bound_operations` as it runs: for each component of a vector, sums, products, comparisons,
/// logic, selections and conversions count as one, divisions, roots, exponentials, logarithms and angles as 4, other functions as
/// what they are made of. Loads and stores count nothing, nor do the choosing of components, signs and the range 0 to 1, which
/// instructions have for their operands and results.
///
/// # Errors
/// What naga finds wrong with the text, or that it has no such variable.
pub fn counted(source: &str) -> Result<Module, String> {
    let mut module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
    let mut validator = Validator::new(ValidationFlags::all(), CAPABILITIES);
    let info = validator.validate(&module).map_err(|e| e.emit_to_string(source))?;
    let counter = module.global_variables.iter().find(|(_, variable)| variable.name.as_deref() == Some(COUNTER));
    let (counter, _) = counter.ok_or_else(|| format!("the program has no {COUNTER}"))?;
    // What expressions are is asked while functions are changed.
    let types = module.clone();
    for (handle, function) in module.functions.iter_mut() {
        count(function, &info[handle], &types, counter);
    }
    for (index, entry) in module.entry_points.iter_mut().enumerate() {
        count(&mut entry.function, info.get_entry_point(index), &types, counter);
    }
    Ok(module)
}

fn count(function: &mut Function, info: &FunctionInfo, module: &Module, counter: Handle<GlobalVariable>) {
    let costs: Vec<u32> = function
        .expressions
        .iter()
        .map(|(at, expression)| cost(expression, &info[at].ty, function, info, module))
        .collect();
    let body = std::mem::take(&mut function.body);
    function.body = with_counts(body, &costs, &mut function.expressions, counter);
}

/// A block in which each run of statements without a branch first adds what it costs.
fn with_counts(
    block: Block,
    costs: &[u32],
    expressions: &mut Arena<Expression>,
    counter: Handle<GlobalVariable>,
) -> Block {
    let mut counted = Block::new();
    let mut open = 0;
    let inner = |block: Block, expressions: &mut Arena<Expression>| with_counts(block, costs, expressions, counter);
    for (statement, span) in block.span_into_iter() {
        if let Statement::Emit(range) = &statement {
            open += range.clone().map(|at| costs[at.index()]).sum::<u32>();
            counted.push(statement, span);
            continue;
        }
        let statement = match statement {
            Statement::Block(block) => Statement::Block(inner(block, expressions)),
            Statement::If { condition, accept, reject } => {
                let (accept, reject) = (inner(accept, expressions), inner(reject, expressions));
                Statement::If { condition, accept, reject }
            }
            Statement::Switch { selector, mut cases } => {
                for case in &mut cases {
                    case.body = inner(std::mem::take(&mut case.body), expressions);
                }
                Statement::Switch { selector, cases }
            }
            Statement::Loop { body, continuing, break_if } => {
                let (body, continuing) = (inner(body, expressions), inner(continuing, expressions));
                Statement::Loop { body, continuing, break_if }
            }
            simple => simple,
        };
        // Before what may leave the block.
        add(open, &mut counted, expressions, counter);
        open = 0;
        counted.push(statement, span);
    }
    add(open, &mut counted, expressions, counter);
    counted
}

/// `counter += by;`
fn add(by: u32, block: &mut Block, expressions: &mut Arena<Expression>, counter: Handle<GlobalVariable>) {
    if by == 0 {
        return;
    }
    let pointer = expressions.append(Expression::GlobalVariable(counter), Span::UNDEFINED);
    let right = expressions.append(Expression::Literal(Literal::U32(by)), Span::UNDEFINED);
    let left = expressions.append(Expression::Load { pointer }, Span::UNDEFINED);
    let sum = Expression::Binary { op: BinaryOperator::Add, left, right };
    let value = expressions.append(sum, Span::UNDEFINED);
    block.push(Statement::Emit(Range::new_from_bounds(left, value)), Span::UNDEFINED);
    block.push(Statement::Store { pointer, value }, Span::UNDEFINED);
}

/// Operations of one expression.
fn cost(
    expression: &Expression,
    ty: &naga::proc::TypeResolution,
    function: &Function,
    info: &FunctionInfo,
    module: &Module,
) -> u32 {
    let result = components(ty.inner_with(&module.types));
    let of = |operand: Handle<Expression>| info[operand].ty.inner_with(&module.types);
    match *expression {
        // A comparison the other way round.
        Expression::Unary { op: UnaryOperator::LogicalNot, .. } => 0,
        Expression::Unary { .. } | Expression::Select { .. } | Expression::Derivative { .. } => result,
        // Bits that are read as another type cost nothing.
        Expression::As { convert, .. } => convert.map_or(0, |_| result),
        Expression::Relational { argument, .. } => components(of(argument)) - 1,
        Expression::Binary { op: BinaryOperator::Multiply, left, right } => match (of(left), of(right)) {
            (TypeInner::Matrix { columns, .. }, TypeInner::Vector { .. } | TypeInner::Matrix { .. }) => {
                result * (2 * u32::from(*columns) - 1)
            }
            (TypeInner::Vector { size, .. }, TypeInner::Matrix { .. }) => result * (2 * u32::from(*size) - 1),
            _ => result,
        },
        Expression::Binary { op: BinaryOperator::Divide | BinaryOperator::Modulo, right, .. } => {
            // By a constant of whole numbers compilers divide by shifts or a product.
            let whole = !matches!(of(right).scalar_kind(), Some(ScalarKind::Float));
            let constant = matches!(function.expressions[right], Expression::Literal(_) | Expression::Constant(_));
            if whole && constant { result } else { SPECIAL * result }
        }
        Expression::Binary { .. } => result,
        Expression::Math { fun, arg, .. } => math(fun, components(of(arg)), result),
        _ => 0,
    }
}

/// Operations of a built-in function of arguments of `n` components.
fn math(fun: MathFunction, n: u32, result: u32) -> u32 {
    use MathFunction as F;
    match fun {
        F::Abs | F::Saturate | F::Transpose => 0,
        F::Dot => 2 * n - 1,
        F::Cross => 9,
        F::Length => 2 * n - 1 + SPECIAL,
        F::Distance => 3 * n - 1 + SPECIAL,
        F::Normalize => 3 * n - 1 + SPECIAL,
        F::Reflect => 4 * n,
        F::Clamp | F::Mix | F::Step => 2 * result,
        F::SmoothStep => (6 + SPECIAL) * result,
        F::Pow => (1 + 2 * SPECIAL) * result,
        F::Tan | F::Atan2 => 2 * SPECIAL * result,
        F::Cos
        | F::Sin
        | F::Acos
        | F::Asin
        | F::Atan
        | F::Exp
        | F::Exp2
        | F::Log
        | F::Log2
        | F::Sqrt
        | F::InverseSqrt => SPECIAL * result,
        _ => result.max(n),
    }
}

fn components(ty: &TypeInner) -> u32 {
    match *ty {
        TypeInner::Vector { size, .. } => u32::from(size),
        TypeInner::Matrix { columns, rows, .. } => u32::from(columns) * u32::from(rows),
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::back::wgsl::WriterFlags;

    /// What a counted program adds to its counter, in the order of its text.
    fn sums(source: &str) -> Vec<u32> {
        let module = counted(&format!("var<private> {COUNTER}: u32 = 0u; {source}")).unwrap();
        let info = Validator::new(ValidationFlags::all(), CAPABILITIES).validate(&module).unwrap();
        let text = naga::back::wgsl::write_string(&module, &info, WriterFlags::empty()).unwrap();
        let counts = text.lines().filter(|line| line.contains(COUNTER));
        let sums = counts.filter_map(|line| line.trim().strip_suffix("u);")?.rsplit_once(" + "));
        sums.map(|(_, number)| number.parse().unwrap()).collect()
    }

    #[test]
    fn each_path_counts_what_it_executes() {
        let branch = "fn f(x: f32) -> f32 { if x > 0.0 { return sqrt(x) + 1.0; } return 3.0 * x - 1.0; }";
        assert_eq!(sums(branch), [1, 5, 2]);
        let round = "fn f(n: u32) -> f32 { var s = 0.0; for (var i = 0u; i < n; i++) { s += exp(s) / s; } return s; }";
        // The test at the loop's head, its body, the step.
        assert_eq!(sums(round), [1, 9, 1]);
    }

    #[test]
    fn components_and_whole_numbers_are_told_apart() {
        assert_eq!(sums("fn f(v: vec3f) -> f32 { return dot(v * 2.0, v.zyx); }"), [3 + 5]);
        assert_eq!(sums("fn f(i: u32) -> u32 { return i / 8u; }"), [1]);
        assert_eq!(sums("fn f(i: u32, j: u32) -> u32 { return i / j; }"), [4]);
        assert_eq!(sums("fn f(m: mat2x2f, v: vec2f) -> vec2f { return m * v; }"), [6]);
        assert_eq!(sums("fn f(i: u32) -> f32 { return bitcast<f32>(i) + f32(i); }"), [2]);
    }

    #[test]
    fn programs_without_the_counter_are_refused() {
        assert!(counted("fn f() {}").unwrap_err().contains(COUNTER));
    }
}
