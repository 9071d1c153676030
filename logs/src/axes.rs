//! Which way the axes of a file point, and how its numbers become components along ours: b is right, forward, up, and n is east,
//! north, up.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::suggest;

/// What may be said of axes.
pub(super) const NAMES: [&str; 6] = ["imu", "gyro", "accel", "reference", "quaternion", "euler"];
/// An axis by its letter: which of ours it lies along, and with which sign.
const BODY: [(char, usize, f64); 6] =
    [('r', 0, 1.0), ('l', 0, -1.0), ('f', 1, 1.0), ('b', 1, -1.0), ('u', 2, 1.0), ('d', 2, -1.0)];
const EARTH: [(char, usize, f64); 6] =
    [('e', 0, 1.0), ('w', 0, -1.0), ('n', 1, 1.0), ('s', 1, -1.0), ('u', 2, 1.0), ('d', 2, -1.0)];
const OURS: [(char, usize, f64); 3] = [('x', 0, 1.0), ('y', 1, 1.0), ('z', 2, 1.0)];

/// Where each axis of a file points, in ours: the axis, and the sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointing([(usize, f64); 3]);

impl Pointing {
    /// As ours.
    pub const OURS: Self = Self([(0, 1.0), (1, 1.0), (2, 1.0)]);

    /// A vector of the file along our axes.
    pub fn apply(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        let mut turned = Vector3::zeros();
        for (value, (axis, sign)) in vector.iter().zip(self.0) {
            turned[axis] = sign * value;
        }
        turned
    }

    /// The same for three numbers that have an axis and no direction, such as temperatures.
    pub fn permute(&self, values: &Vector3<f64>) -> Vector3<f64> {
        let mut turned = *values;
        for (value, (axis, _)) in values.iter().zip(self.0) {
            turned[axis] = *value;
        }
        turned
    }

    /// As a matrix that takes vectors of the file to ours.
    pub fn matrix(&self) -> Matrix3<f64> {
        let mut matrix = Matrix3::zeros();
        for (column, (axis, sign)) in self.0.into_iter().enumerate() {
            matrix[(axis, column)] = sign;
        }
        matrix
    }

    /// Whether they are right-handed.
    pub fn is_right_handed(&self) -> bool {
        self.matrix().determinant() > 0.0
    }

    /// All 48 of them, ours first.
    pub fn all() -> impl Iterator<Item = Self> {
        let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
        orders.into_iter().flat_map(|order| {
            (0..8_u8).map(move |signs| {
                Self(std::array::from_fn(|axis| {
                    (order[axis], if signs >> axis & 1 == 1 { -1.0 } else { 1.0 })
                }))
            })
        })
    }

    /// Reads three letters (`frd`), or signed axes of ours (`+y+x-z`).
    fn read(text: &str, letters: &[(char, usize, f64)], examples: &str) -> Result<Self, String> {
        let refusal = || {
            format!(
                "`{text}` does not say where three axes point: {examples}, or where they point in ours, as +y-x+z"
            )
        };
        let mut found = Vec::new();
        let mut sign = 1.0;
        for c in text.trim().to_ascii_lowercase().chars() {
            let letter = letters.iter().chain(&OURS).find(|(letter, ..)| *letter == c);
            match (c, letter) {
                ('+', _) => sign = 1.0,
                ('-', _) => sign = -1.0,
                (_, Some((_, axis, direction))) => {
                    found.push((*axis, sign * direction));
                    sign = 1.0;
                }
                _ => return Err(refusal()),
            }
        }
        let axes: [(usize, f64); 3] = found.try_into().map_err(|_| refusal())?;
        let each = (0..3).all(|ours| axes.iter().any(|(axis, _)| *axis == ours));
        each.then_some(Self(axes)).ok_or_else(refusal)
    }

    /// By the letters of a body's directions where they are such, as `frd`.
    pub fn body_name(&self) -> String {
        let letter = |(axis, sign): (usize, f64)| {
            BODY.iter().find(|(_, a, s)| *a == axis && *s == sign).map_or('?', |(letter, ..)| *letter)
        };
        self.0.into_iter().map(letter).collect()
    }

    /// By where each axis points in ours, as `+y+x-z`.
    pub fn signed_name(&self) -> String {
        self.0
            .into_iter()
            .map(|(axis, sign)| format!("{}{}", if sign > 0.0 { '+' } else { '-' }, OURS[axis].0))
            .collect()
    }
}

/// North, east, down.
pub(crate) fn ned() -> Pointing {
    Pointing([(1, 1.0), (0, 1.0), (2, -1.0)])
}

/// How a quaternion stands in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct QuaternionForm {
    scalar_last: bool,
    inverse: bool,
}

impl QuaternionForm {
    fn read(text: &str) -> Result<Self, String> {
        let lower = text.to_ascii_lowercase();
        let mut rest = lower.as_str();
        let mut form = Self { scalar_last: false, inverse: false };
        for (piece, change) in [
            ("wxyz", None),
            ("xyzw", Some(true)),
            ("reference-to-body", Some(false)),
            ("body-to-reference", None),
        ] {
            if let Some(at) = rest.find(piece) {
                let left = rest[..at].trim_matches(|c: char| c == ' ' || c == '-' || c == '+');
                let right = rest[at + piece.len()..].trim_matches(|c: char| c == ' ' || c == '-' || c == '+');
                match change {
                    Some(true) => form.scalar_last = true,
                    Some(false) => form.inverse = true,
                    None => {}
                }
                rest = if left.is_empty() { right } else { left };
            }
        }
        if rest.is_empty() && !lower.is_empty() {
            return Ok(form);
        }
        Err(format!(
            "`{text}` is no form of a quaternion: `wxyz` or `xyzw`, then `body-to-reference` (which is meant where nothing is \
             said) or `reference-to-body`"
        ))
    }
}

/// The order of three rotations about the axes of the body, each about the axes turned by those before.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EulerOrder([usize; 3]);

impl EulerOrder {
    fn read(text: &str) -> Result<Self, String> {
        let axes: Vec<usize> =
            text.trim().to_ascii_lowercase().chars().filter_map(|c| "xyz".find(c)).collect();
        match <[usize; 3]>::try_from(axes) {
            Ok(order) if (0..3).all(|axis| order.contains(&axis)) && text.trim().len() == 3 => {
                Ok(Self(order))
            }
            _ => Err(format!(
                "`{text}` is no order of three rotations: zyx turns by yaw about z, then by pitch about y, then by roll about x \
                 (C_bn = Rz Ry Rx); others are xyz, xzy, yxz, yzx, zxy"
            )),
        }
    }

    /// The rotation that takes vectors in the body to the reference, from the angles about x, y and z, rad.
    fn rotation(&self, angles: &Vector3<f64>) -> UnitQuaternion<f64> {
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        self.0.iter().fold(UnitQuaternion::identity(), |turned, axis| {
            turned * UnitQuaternion::from_axis_angle(&axes[*axis], angles[*axis])
        })
    }
}

/// Which way a file's axes point.
///
/// `imu=frd,reference=ned` is all that a log in forward-right-down and north-east-down needs. Three letters name the directions
/// of the file's x, y and z (r l f b u d for the body, e w n s u d for the reference); `+y-x+z` says the same in our axes: the
/// file's x points along our y, its y against our x. `gyro` and `accel` go before `imu` for their own triad. `quaternion` says
/// the order of the components and the direction; `euler` the order of the rotations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axes {
    imu: Option<Pointing>,
    gyro: Option<Pointing>,
    accel: Option<Pointing>,
    reference: Option<Pointing>,
    quaternion: Option<QuaternionForm>,
    euler: Option<EulerOrder>,
}

impl Axes {
    /// Takes in one saying, such as `imu` and `frd`.
    ///
    /// # Errors
    /// What would have been right.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        let body = |text| Pointing::read(text, &BODY, "frd, flu, rfu");
        match name {
            "imu" => self.imu = Some(body(text)?),
            "gyro" => self.gyro = Some(body(text)?),
            "accel" => self.accel = Some(body(text)?),
            "reference" => self.reference = Some(Pointing::read(text, &EARTH, "enu, ned, nwu")?),
            "quaternion" => self.quaternion = Some(QuaternionForm::read(text)?),
            "euler" => self.euler = Some(EulerOrder::read(text)?),
            _ => return Err(format!("`{name}` has no axes: {}", suggest::hint(name, NAMES))),
        }
        Ok(())
    }

    /// What `self` says, and what it leaves open from `other`.
    pub fn or(self, other: &Self) -> Self {
        Self {
            imu: self.imu.or(other.imu),
            gyro: self.gyro.or(other.gyro),
            accel: self.accel.or(other.accel),
            reference: self.reference.or(other.reference),
            quaternion: self.quaternion.or(other.quaternion),
            euler: self.euler.or(other.euler),
        }
    }

    pub(super) fn gyro(&self) -> Pointing {
        self.gyro.or(self.imu).unwrap_or(Pointing::OURS)
    }

    pub(super) fn accel(&self) -> Pointing {
        self.accel.or(self.imu).unwrap_or(Pointing::OURS)
    }

    pub(super) fn reference(&self) -> Pointing {
        self.reference.unwrap_or(Pointing::OURS)
    }

    /// Whether the axes of the unit were named.
    pub(super) fn names_unit(&self) -> bool {
        self.imu.is_some() || self.gyro.is_some() || self.accel.is_some()
    }

    /// Whether the reference's axes were named.
    pub(super) fn names_reference(&self) -> bool {
        self.reference.is_some()
    }

    pub(super) fn quaternion_is_scalar_last(&self) -> bool {
        self.quaternion.is_some_and(|form| form.scalar_last)
    }

    /// Whether an attitude would have to be that of left-handed axes.
    pub(super) fn attitude_is_impossible(&self) -> bool {
        self.imu.unwrap_or(Pointing::OURS).is_right_handed() != self.reference().is_right_handed()
    }

    pub(super) fn has_euler_order(&self) -> bool {
        self.euler.is_some()
    }

    /// C_bn in our axes from a quaternion of the file, components w, x, y, z. Its norm is kept, so that it can be checked.
    pub(super) fn attitude(&self, wxyz: [f64; 4]) -> [f64; 4] {
        let [w, x, y, z] = wxyz;
        let form = self.quaternion.unwrap_or(QuaternionForm { scalar_last: false, inverse: false });
        let (body, reference) = (self.imu.unwrap_or(Pointing::OURS), self.reference());
        if !form.inverse && body == Pointing::OURS && reference == Pointing::OURS {
            return wxyz;
        }
        let norm = (w * w + x * x + y * y + z * z).sqrt();
        if !(norm > 0.0) {
            return wxyz;
        }
        let read = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let read = if form.inverse { read.inverse() } else { read };
        let ours = self.turn(&read);
        [ours.w * norm, ours.i * norm, ours.j * norm, ours.k * norm]
    }

    /// C_bn in our axes, components w, x, y, z, from Euler angles about the file's x, y and z, rad.
    pub(super) fn euler(&self, angles: &Vector3<f64>) -> [f64; 4] {
        let order = self.euler.unwrap_or(EulerOrder([2, 1, 0]));
        if angles.iter().any(|angle| !angle.is_finite()) {
            return [f64::NAN; 4];
        }
        let ours = self.turn(&order.rotation(angles));
        [ours.w, ours.i, ours.j, ours.k]
    }

    fn turn(&self, read: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let (body, reference) = (self.imu.unwrap_or(Pointing::OURS).matrix(), self.reference().matrix());
        let turned = reference * read.to_rotation_matrix().matrix() * body.transpose();
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turned))
    }
}

impl std::str::FromStr for Axes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut axes = Self::default();
        for entry in text.split(',').filter(|entry| !entry.trim().is_empty()) {
            let Some((name, value)) = entry.split_once('=') else {
                return Err(format!("`{}` has no `=`: imu=frd,reference=ned was expected", entry.trim()));
            };
            axes.set(name.trim(), value.trim())?;
        }
        if axes == Self::default() {
            return Err("imu=frd,reference=ned was expected".into());
        }
        Ok(axes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_and_signed_axes_say_the_same() {
        let of = |text: &str| Pointing::read(text, &BODY, "").expect(text);
        assert_eq!(of("rfu"), Pointing::OURS);
        assert_eq!(of("frd"), of("+y+x-z"));
        assert_eq!(of("flu"), of("+y-x+z"));
        // forward 1, right 2, down 3 are right 2, forward 1, up -3
        assert_eq!(of("frd").apply(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(2.0, 1.0, -3.0));
        assert_eq!(of("flu").apply(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(-2.0, 1.0, 3.0));
        assert_eq!(of("frd").permute(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(2.0, 1.0, 3.0));
        assert!(of("frd").is_right_handed() && !of("fru").is_right_handed());
        for text in ["frr", "fr", "frdu", "abc", "", "+y-y+z"] {
            assert!(Pointing::read(text, &BODY, "").is_err(), "{text}");
        }
    }

    #[test]
    fn every_pointing_is_there_once() {
        let all: Vec<Pointing> = Pointing::all().collect();
        assert_eq!((all.len(), all[0]), (48, Pointing::OURS));
        assert_eq!(all.iter().filter(|axes| axes.is_right_handed()).count(), 24);
        for (index, axes) in all.iter().enumerate() {
            assert!(!all[..index].contains(axes));
            let vector = Vector3::new(1.0, 2.0, 3.0);
            assert_eq!(axes.matrix() * vector, axes.apply(&vector));
        }
    }

    /// A unit at heading 30 deg east of north, nose up by 10 deg, right wing down by 5 deg: its axes in both conventions.
    #[test]
    fn an_attitude_of_frd_in_ned_is_ours() {
        let (roll, pitch, yaw) = (5_f64.to_radians(), 10_f64.to_radians(), 30_f64.to_radians());
        let axes: Axes = "imu=frd,reference=ned,euler=zyx".parse().expect("axes");
        let [w, x, y, z] = axes.euler(&Vector3::new(roll, pitch, yaw));
        let c_bn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let forward = c_bn * Vector3::y();
        let expected = Vector3::new(yaw.sin() * pitch.cos(), yaw.cos() * pitch.cos(), pitch.sin());
        assert!((forward - expected).norm() < 1e-15);
        // the right wing points down by asin(sin roll cos pitch)
        assert!(((c_bn * Vector3::x()).z + roll.sin() * pitch.cos()).abs() < 1e-15);
        // and the quaternion of the file says the same, also as its inverse
        let file = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let wxyz = |q: UnitQuaternion<f64>| [q.w, q.i, q.j, q.k];
        for (text, given) in [("wxyz", wxyz(file)), ("wxyz reference-to-body", wxyz(file.inverse()))] {
            let mut with = axes.clone();
            with.set("quaternion", text).expect(text);
            let [w, x, y, z] = with.attitude(given);
            let read = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            assert!(read.angle_to(&c_bn) < 1e-7, "{text}");
        }
    }

    #[test]
    fn forms_are_read() {
        let form = |text| QuaternionForm::read(text);
        assert_eq!(form("xyzw reference-to-body"), Ok(QuaternionForm { scalar_last: true, inverse: true }));
        assert_eq!(form("wxyz-body-to-reference"), Ok(QuaternionForm { scalar_last: false, inverse: false }));
        assert_eq!(form("reference-to-body"), Ok(QuaternionForm { scalar_last: false, inverse: true }));
        assert!(form("xyz").is_err() && form("").is_err() && form("wxyz up").is_err());
        assert!("imu=frd,axle=ned".parse::<Axes>().is_err_and(|error| error.contains("valid names")));
        assert!("frd".parse::<Axes>().is_err());
        let mixed: Axes = "imu=frd,accel=flu".parse().expect("axes");
        assert_eq!((mixed.gyro().body_name(), mixed.accel().body_name()), ("frd".into(), "flu".into()));
    }
}
