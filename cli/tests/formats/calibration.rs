// Calibration of an inertial unit, written by sinscal 0.1.0
//
// calibration.json, SHA-256 e8a0688f37a6fd5e21768e19c21292d7adb1f421fad99e1ba3334c7e22bf74cf
// filter 43d-b, log unit.parquet
// 3765 s of data, NIS per degree of freedom 1.00
//
// Axes: b, right-forward-up. Units: SI, angles in rad, temperatures in degC. Sigma: one standard deviation.
// The error of a sensor is measured - true, so that compensation subtracts it:
//     omega = omega_measured - d_omega
//     f     = f_measured - d_f
// where d_omega (rad/s) and d_f (m/s^2) are the sums of the lines so called at the effects below. They are taken at
// the true omega and f: begin with the measured ones and repeat, two rounds for scale errors of 1e-3, four for 3 %.
// j, k: the axes other than i; A_i: amplitude of the dither's rate about i (rad/s); T_i, T_gi: temperature of
// accelerometer and gyro i; t: time since the start (s); C: from b to east-north-up.
// Only what was estimated stands here; whatever is not there counts as zero.

// T_ref, where the temperature effects vanish
/// reference temperature, degC
pub const REFERENCE_TEMPERATURE: f64 = 25.0;

// gyro-scale: scale-factor error of each gyro
//     d_omega_i = s_i omega_i
/// gyro scale x, 1
pub const GYRO_SCALE_X: f64 = 7.007804630242279e-06;
/// gyro scale x sigma, 1
pub const GYRO_SCALE_X_SIGMA: f64 = 4.0283123552221974e-07;
/// gyro scale y, 1
pub const GYRO_SCALE_Y: f64 = -3.240122798331708e-05;
/// gyro scale y sigma, 1
pub const GYRO_SCALE_Y_SIGMA: f64 = 4.0035603108342477e-07;
/// gyro scale z, 1
pub const GYRO_SCALE_Z: f64 = -6.054907155383354e-06;
/// gyro scale z sigma, 1
pub const GYRO_SCALE_Z_SIGMA: f64 = 3.9910265026172873e-07;

// gyro-misalignment: installation errors of the gyros; yx is what gyro y reads of the rate about x
//     d_omega_y = m_yx omega_x; d_omega_z = m_zx omega_x + m_zy omega_y
/// gyro misalignment yx, rad
pub const GYRO_MISALIGNMENT_YX: f64 = 1.2620566357346915e-04;
/// gyro misalignment yx sigma, rad
pub const GYRO_MISALIGNMENT_YX_SIGMA: f64 = 1.390808135128455e-06;
/// gyro misalignment zx, rad
pub const GYRO_MISALIGNMENT_ZX: f64 = 1.2081293513304528e-04;
/// gyro misalignment zx sigma, rad
pub const GYRO_MISALIGNMENT_ZX_SIGMA: f64 = 1.3858181786670205e-06;
/// gyro misalignment zy, rad
pub const GYRO_MISALIGNMENT_ZY: f64 = 8.19041163676074e-05;
/// gyro misalignment zy sigma, rad
pub const GYRO_MISALIGNMENT_ZY_SIGMA: f64 = 1.3854737201194576e-06;

// gyro-bias: constant drift of each gyro
//     d_omega_i = eps_i
/// gyro bias x, rad/s
pub const GYRO_BIAS_X: f64 = -2.6067777167798046e-07;
/// gyro bias x sigma, rad/s
pub const GYRO_BIAS_X_SIGMA: f64 = 7.010721965101013e-09;
/// gyro bias y, rad/s
pub const GYRO_BIAS_Y: f64 = -1.505419654462604e-07;
/// gyro bias y sigma, rad/s
pub const GYRO_BIAS_Y_SIGMA: f64 = 7.3570312660934715e-09;
/// gyro bias z, rad/s
pub const GYRO_BIAS_Z: f64 = 1.9612764633938454e-07;
/// gyro bias z sigma, rad/s
pub const GYRO_BIAS_Z_SIGMA: f64 = 6.877560792689002e-09;

// accel-scale: scale-factor error of each accelerometer
//     d_f_i = s_i f_i
/// accel scale x, 1
pub const ACCEL_SCALE_X: f64 = -1.3128298342938077e-05;
/// accel scale x sigma, 1
pub const ACCEL_SCALE_X_SIGMA: f64 = 2.1251742641519864e-07;
/// accel scale y, 1
pub const ACCEL_SCALE_Y: f64 = 9.785973110507377e-05;
/// accel scale y sigma, 1
pub const ACCEL_SCALE_Y_SIGMA: f64 = 4.534709036148468e-07;
/// accel scale z, 1
pub const ACCEL_SCALE_Z: f64 = -9.015513045687109e-05;
/// accel scale z sigma, 1
pub const ACCEL_SCALE_Z_SIGMA: f64 = 2.0217653903756956e-07;

// accel-misalignment: installation errors of the accelerometers; xy is what accelerometer x reads of the force along y
//     d_f_i = sum over j != i of m_ij f_j
/// accel misalignment xy, rad
pub const ACCEL_MISALIGNMENT_XY: f64 = 1.956935631319811e-05;
/// accel misalignment xy sigma, rad
pub const ACCEL_MISALIGNMENT_XY_SIGMA: f64 = 1.0557862156763287e-06;
/// accel misalignment xz, rad
pub const ACCEL_MISALIGNMENT_XZ: f64 = -1.0653821054115652e-04;
/// accel misalignment xz sigma, rad
pub const ACCEL_MISALIGNMENT_XZ_SIGMA: f64 = 1.2576868919860377e-06;
/// accel misalignment yx, rad
pub const ACCEL_MISALIGNMENT_YX: f64 = -1.1512469188064414e-04;
/// accel misalignment yx sigma, rad
pub const ACCEL_MISALIGNMENT_YX_SIGMA: f64 = 5.826405296953396e-07;
/// accel misalignment yz, rad
pub const ACCEL_MISALIGNMENT_YZ: f64 = -8.792844782004342e-05;
/// accel misalignment yz sigma, rad
pub const ACCEL_MISALIGNMENT_YZ_SIGMA: f64 = 1.0552110072425999e-06;
/// accel misalignment zx, rad
pub const ACCEL_MISALIGNMENT_ZX: f64 = -1.6555034938081996e-05;
/// accel misalignment zx sigma, rad
pub const ACCEL_MISALIGNMENT_ZX_SIGMA: f64 = 8.981151248064853e-07;
/// accel misalignment zy, rad
pub const ACCEL_MISALIGNMENT_ZY: f64 = 8.437639181507132e-05;
/// accel misalignment zy sigma, rad
pub const ACCEL_MISALIGNMENT_ZY_SIGMA: f64 = 5.828789695628932e-07;

// accel-bias: constant bias of each accelerometer
//     d_f_i = b_i
/// accel bias x, m/s^2
pub const ACCEL_BIAS_X: f64 = -0.0011457499915834611;
/// accel bias x sigma, m/s^2
pub const ACCEL_BIAS_X_SIGMA: f64 = 5.71501818744268e-06;
/// accel bias y, m/s^2
pub const ACCEL_BIAS_Y: f64 = 2.7477316403699267e-04;
/// accel bias y sigma, m/s^2
pub const ACCEL_BIAS_Y_SIGMA: f64 = 5.4321733339494985e-06;
/// accel bias z, m/s^2
pub const ACCEL_BIAS_Z: f64 = -3.041619216666383e-04;
/// accel bias z sigma, m/s^2
pub const ACCEL_BIAS_Z_SIGMA: f64 = 5.592833773179055e-06;

// accel-quadratic: quadratic scale-factor error of each accelerometer
//     d_f_i = k_i f_i^2
/// accel quadratic x, s^2/m
pub const ACCEL_QUADRATIC_X: f64 = 1.0357811582862309e-07;
/// accel quadratic x sigma, s^2/m
pub const ACCEL_QUADRATIC_X_SIGMA: f64 = 5.500667011131172e-08;
/// accel quadratic y, s^2/m
pub const ACCEL_QUADRATIC_Y: f64 = 8.922261207977459e-07;
/// accel quadratic y sigma, s^2/m
pub const ACCEL_QUADRATIC_Y_SIGMA: f64 = 5.5054635294730056e-08;
/// accel quadratic z, s^2/m
pub const ACCEL_QUADRATIC_Z: f64 = -1.0564671477417617e-06;
/// accel quadratic z sigma, s^2/m
pub const ACCEL_QUADRATIC_Z_SIGMA: f64 = 5.4535711458349066e-08;

// outer-lever-arm: vector from the sensitive centre to the observed point, in b
//     z_v = v + C (omega_eb x l) - v_ref; z_p = p + C l - p_ref
/// outer lever arm x, m
pub const OUTER_LEVER_ARM_X: f64 = 0.19923069792752512;
/// outer lever arm x sigma, m
pub const OUTER_LEVER_ARM_X_SIGMA: f64 = 3.370379607139492e-04;
/// outer lever arm y, m
pub const OUTER_LEVER_ARM_Y: f64 = 0.15159665102820502;
/// outer lever arm y sigma, m
pub const OUTER_LEVER_ARM_Y_SIGMA: f64 = 3.393828457300367e-04;
/// outer lever arm z, m
pub const OUTER_LEVER_ARM_Z: f64 = -0.12653775385501376;
/// outer lever arm z sigma, m
pub const OUTER_LEVER_ARM_Z_SIGMA: f64 = 3.3384501359430877e-04;

// inner-lever-arm: displacement of each accelerometer along its own axis from the sensitive centre
//     d_f_i = -(omega_j^2 + omega_k^2 + A_j^2/2 + A_k^2/2) r_i
/// inner lever arm x, m
pub const INNER_LEVER_ARM_X: f64 = 0.03834160812011185;
/// inner lever arm x sigma, m
pub const INNER_LEVER_ARM_X_SIGMA: f64 = 2.798086810451706e-04;
/// inner lever arm y, m
pub const INNER_LEVER_ARM_Y: f64 = 0.040984471997797006;
/// inner lever arm y sigma, m
pub const INNER_LEVER_ARM_Y_SIGMA: f64 = 2.8407692989406704e-04;
/// inner lever arm z, m
pub const INNER_LEVER_ARM_Z: f64 = 0.03310774476520106;
/// inner lever arm z sigma, m
pub const INNER_LEVER_ARM_Z_SIGMA: f64 = 2.71543505813233e-04;

// accel-delay: how much later than the gyros the accelerometers are stamped
//     d_f = -tau f_b'
/// accel delay tau, s
pub const ACCEL_DELAY_TAU: f64 = 4.5986996433803955e-04;
/// accel delay tau sigma, s
pub const ACCEL_DELAY_TAU_SIGMA: f64 = 3.580465454890501e-06;

// accel-temperature-scale: change of each accelerometer's scale factor with its temperature above the reference
//     d_f_i = k_i (T_i - T_ref) f_i
/// accel temperature scale x, 1/K
pub const ACCEL_TEMPERATURE_SCALE_X: f64 = -5.167751695127955e-06;
/// accel temperature scale x sigma, 1/K
pub const ACCEL_TEMPERATURE_SCALE_X_SIGMA: f64 = 3.797847339198569e-08;
/// accel temperature scale y, 1/K
pub const ACCEL_TEMPERATURE_SCALE_Y: f64 = -7.5841829854555535e-06;
/// accel temperature scale y sigma, 1/K
pub const ACCEL_TEMPERATURE_SCALE_Y_SIGMA: f64 = 7.428323436723638e-08;
