//! Operators that follow from others.

/// `+=`, `-=`, `*=` and `/=` of a number, by its sum, difference, product and quotient.
macro_rules! assign_operators {
    ([$($generic:tt)*] $Number:ty) => {
        $crate::numerics::assign::assign_operators!([$($generic)*] $Number, AddAssign add_assign +);
        $crate::numerics::assign::assign_operators!([$($generic)*] $Number, SubAssign sub_assign -);
        $crate::numerics::assign::assign_operators!([$($generic)*] $Number, MulAssign mul_assign *);
        $crate::numerics::assign::assign_operators!([$($generic)*] $Number, DivAssign div_assign /);
    };
    ([$($generic:tt)*] $Number:ty, $Operator:ident $method:ident $symbol:tt) => {
        impl<$($generic)*> std::ops::$Operator for $Number {
            #[inline(always)]
            fn $method(&mut self, other: Self) {
                *self = *self $symbol other;
            }
        }
    };
}
pub(super) use assign_operators;
