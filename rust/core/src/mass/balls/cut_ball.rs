//! A unit ball cut by planes: volume, first and second moments about its center.
//!
//! By the divergence theorem they are integrals over the boundary, which consists of a patch of the sphere and of plane faces.
//! With h the height of a face over the center, u its normal, `x = h u + y` on it, and n a point of the unit sphere:
//!
//! `V = ∫dΩ/3 + Σ h ∫dA/3`, `∫ x dV = ∫ n dΩ/4 + Σ h ∫ x dA/4`, `∫ x xᵀ dV = ∫ n nᵀ dΩ/5 + Σ h ∫ x xᵀ dA/5`.
//!
//! The boundary of the patch are arcs of the circles in which the planes cut the sphere. Along them, by Stokes' theorem, patch to the
//! left and ν its outward normal in the sphere,
//!
//! `∫ n dΩ = ½ ∮ n × dn`, `∫ (n nᵀ − 1/3) dΩ = −⅙ ∮ (ν nᵀ + n νᵀ) ds`,
//!
//! and `∫ dΩ` is known up to whole spheres from the arcs and one point p: each arc adds the triangle from p to its chord and the segment
//! between chord and arc. A face is a convex polygon cut by a disk; its moments are sums over the triangles from the middle of the disk to its edges, and
//! over sectors.
//!
//! The polygons are those of a polyhedron, from which each plane cuts a piece. An edge belongs to two faces, and where it leaves the
//! ball is computed in the same way for both; so the arcs form closed curves for any rounding, and what rounding moves changes the sums by no more
//! than rounding.
//!
//! What a face adds is summed in its own axes s, t, u and turned once.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::mass::error_bound::UNIT;

/// Volume, first and second moments about the center of a ball.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    pub(super) volume: f64,
    pub(super) first: Vector3<f64>,
    pub(super) second: Matrix3<f64>,
    /// What rounding can have done to the volume.
    pub(super) error: f64,
    pub(super) radius: f64,
}

impl Moments {
    /// The same of a ball of this radius.
    pub(super) fn of_radius(&self, radius: f64) -> Self {
        let cube = radius * radius * radius;
        Self {
            volume: self.volume * cube,
            first: self.first * (cube * radius),
            second: self.second * (cube * radius * radius),
            error: self.error * cube,
            radius,
        }
    }

    /// Of the whole unit ball.
    fn of_ball() -> Self {
        Self {
            volume: 4.0 * PI / 3.0,
            first: Vector3::zeros(),
            second: Matrix3::identity() * (4.0 * PI / 15.0),
            error: 4.0 * UNIT,
            radius: 1.0,
        }
    }
}

/// A plane: what remains is `normal·x ≤ height`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) normal: Vector3<f64>,
    pub(super) height: f64,
}

/// Half the edge of the cube from which the planes cut. Its faces do not meet the unit ball.
const HALF_EDGE: f64 = 1.5;

/// A plane that leaves no corner farther than this outside cuts nothing: it passes along a face, an edge or a corner.
const ALONG: f64 = 8.0 * UNIT;

/// Cuts a ball by planes; its memory serves for the next ball.
#[derive(Default)]
pub(super) struct Cutter {
    cell: Polyhedron,
    /// Of the corners over a plane.
    heights: Vec<f64>,
    /// Corners beyond it.
    outer: Vec<usize>,
    /// Half-edges from corners beyond it to others, and for each half-edge the new corner on it.
    cuts: Vec<usize>,
    made: Vec<usize>,
    is_inside: Vec<bool>,
    is_done: Vec<bool>,
    /// The corners of a face.
    face: Vec<usize>,
    arcs: Vec<Arc>,
    /// Of the arcs, cut into pieces.
    points: Vec<Vector3<f64>>,
}

/// A convex polyhedron with three edges at each corner. Those of corner c are the half-edges 3c, 3c + 1 and 3c + 2, counter-clockwise
/// seen from outside.
///
/// Each edge that a plane meets gets a corner of its own. So there are three edges also where many planes meet in a point, and some
/// of them have no length.
#[derive(Default)]
struct Polyhedron {
    corners: Vec<Vector3<f64>>,
    /// Of each half-edge, the same edge from its other end.
    twins: Vec<usize>,
    /// Of each half-edge, the number of the plane of the face on its left.
    planes: Vec<usize>,
    /// Corners that were cut off; their places are not numbers.
    free: Vec<usize>,
}

/// The next half-edge of a corner, counter-clockwise.
fn turn(edge: usize) -> usize {
    if edge % 3 == 2 { edge - 2 } else { edge + 1 }
}

impl Polyhedron {
    /// A cube about the origin, no face of which is in a plane that has a number.
    fn make_cube(&mut self) {
        self.corners.clear();
        self.twins.clear();
        self.planes.clear();
        self.free.clear();
        // The bits of a corner are the signs of x, y and z. Edges along x, y, z are counter-clockwise at every second corner.
        let edge = |corner: usize, axis: usize| {
            let is_right = corner.count_ones() % 2 == 1;
            3 * corner + if is_right { axis } else { (3 - axis) % 3 }
        };
        self.twins.resize(24, 0);
        self.planes.resize(24, usize::MAX);
        for corner in 0..8 {
            let side = |bit: usize| HALF_EDGE * (2.0 * (corner >> bit & 1) as f64 - 1.0);
            self.corners.push(Vector3::new(side(0), side(1), side(2)));
            for axis in 0..3 {
                self.twins[edge(corner, axis)] = edge(corner ^ (1 << axis), axis);
            }
        }
    }

    /// Adds a corner on a half-edge from a corner that is cut off; its twin now ends there. The new edges are left open.
    fn add_corner(&mut self, place: Vector3<f64>, edge: usize, number: usize) -> usize {
        let corner = self.free.pop().unwrap_or(self.corners.len());
        if corner == self.corners.len() {
            self.corners.push(place);
            self.twins.extend([0; 3]);
            self.planes.extend([0; 3]);
        }
        let twin = self.twins[edge];
        self.corners[corner] = place;
        self.twins[3 * corner] = twin;
        self.twins[twin] = 3 * corner;
        self.planes[3 * corner] = self.planes[edge];
        self.planes[3 * corner + 1] = number;
        self.planes[3 * corner + 2] = self.planes[twin];
        corner
    }

    /// The corners of the face on the left of a half-edge, in order.
    fn go_round(&self, edge: usize, is_done: &mut [bool], corners: &mut Vec<usize>) {
        corners.clear();
        let mut at = edge;
        loop {
            is_done[at] = true;
            corners.push(at / 3);
            at = turn(turn(self.twins[at]));
            if at == edge {
                return;
            }
        }
    }
}

impl Cutter {
    /// The moments of the unit ball cut by these planes.
    pub(super) fn moments(&mut self, planes: &[Plane]) -> Moments {
        if planes.is_empty() {
            return Moments::of_ball();
        }
        self.cell.make_cube();
        for (number, plane) in planes.iter().enumerate() {
            if !self.cut(number, plane) {
                return Moments::default();
            }
        }
        self.measure(planes)
    }

    /// Cuts the polyhedron by a plane; false where nothing is left.
    fn cut(&mut self, number: usize, plane: &Plane) -> bool {
        let cell = &mut self.cell;
        self.heights.clear();
        let height = |corner: &Vector3<f64>| plane.normal.dot(corner) - plane.height;
        self.heights.extend(cell.corners.iter().map(height));
        let heights = &self.heights;
        let is_outer = |corner: usize| heights[corner] > ALONG;
        self.outer.clear();
        (self.outer).extend((0..heights.len()).filter(|&corner| is_outer(corner)));
        if self.outer.is_empty() {
            return true;
        }
        if self.outer.len() + cell.free.len() == heights.len() {
            return false;
        }
        self.cuts.clear();
        self.made.resize(self.made.len().max(3 * heights.len()), 0);
        for &outer in &self.outer {
            for edge in 3 * outer..3 * outer + 3 {
                let inner = cell.twins[edge] / 3;
                if is_outer(inner) {
                    continue;
                }
                let (p, q) = (heights[inner], heights[outer]);
                let part = (p / (p - q)).clamp(0.0, 1.0);
                let start = cell.corners[inner];
                let place = start + (cell.corners[outer] - start) * part;
                self.made[edge] = cell.add_corner(place, edge, number);
                self.cuts.push(edge);
            }
        }
        // Back along each face that is cut, from where it comes back to where it left, is an edge of the new face.
        for &edge in &self.cuts {
            let mut at = turn(edge);
            while is_outer(cell.twins[at] / 3) {
                at = turn(cell.twins[at]);
            }
            let (from, to) = (3 * self.made[edge] + 1, 3 * self.made[at] + 2);
            cell.twins[from] = to;
            cell.twins[to] = from;
        }
        for &outer in &self.outer {
            cell.corners[outer] = Vector3::repeat(f64::NAN);
        }
        cell.free.extend(&self.outer);
        true
    }

    /// The moments of the unit ball within the polyhedron.
    fn measure(&mut self, planes: &[Plane]) -> Moments {
        let cell = &self.cell;
        self.is_inside.clear();
        (self.is_inside).extend(cell.corners.iter().map(|r| r.norm_squared() <= 1.0));
        self.is_done.clear();
        self.is_done.resize(cell.twins.len(), false);
        for &corner in &cell.free {
            self.is_done[3 * corner..3 * corner + 3].fill(true);
        }
        self.arcs.clear();
        let mut sum = Boundary::default();
        let (mut largest, mut caps) = (0.0_f64, 0.0);
        for edge in 0..cell.twins.len() {
            let Some(plane) = (planes.get(cell.planes[edge]))
                .filter(|plane| !self.is_done[edge] && plane.height.abs() < 1.0)
            else {
                continue; // of the cube, or of a face that was measured
            };
            cell.go_round(edge, &mut self.is_done, &mut self.face);
            let cap = TAU * (1.0 - plane.height);
            largest = largest.max(cap);
            caps += cap;
            let mut disk = Disk::new(plane, &mut self.arcs);
            disk.go_round(&cell.corners, &self.is_inside, &self.face);
            disk.finish(&mut sum);
        }
        let removed = removed_area(&self.arcs, &mut self.points);
        let whole = 2.0 * TAU;
        let mut area = (-removed).rem_euclid(whole);
        // The patch is smaller than the sphere without its largest cap, and larger than the sphere without all of them.
        if area > whole - 0.5 * largest {
            area -= whole;
        } else if area < 0.5 * (whole - caps) {
            area += whole;
        }
        sum.moments(area)
    }
}

/// An arc of the circle in which a plane cuts the unit sphere, counter-clockwise about its normal.
struct Arc {
    plane: Plane,
    from: Vector3<f64>,
    to: Vector3<f64>,
    angle: f64,
    is_circle: bool,
}

/// What the integrals over the boundary come to, but for the area of the patch.
#[derive(Default)]
struct Boundary {
    faces: usize,
    /// `3 V`.
    volume: f64,
    /// `4 ∫ x dV`.
    first: Vector3<f64>,
    /// `5 ∫ x xᵀ dV`.
    second: Matrix3<f64>,
}

impl Boundary {
    /// The moments, with this area of the patch.
    fn moments(&self, area: f64) -> Moments {
        let second = (self.second + Matrix3::identity() * (area / 3.0)) * 0.2;
        Moments {
            volume: (self.volume + area) / 3.0,
            first: self.first * 0.25,
            second: (second + second.transpose()) * 0.5,
            error: (112 + 16 * self.faces) as f64 * UNIT,
            radius: 1.0,
        }
    }
}

/// A face: a polygon cut by the disk in which its plane cuts the unit ball.
struct Disk<'a> {
    plane: Plane,
    /// Axes in the plane, right-handed with its normal.
    axes: [Vector3<f64>; 2],
    arcs: &'a mut Vec<Arc>,
    /// Over the triangles, with y = (a, b) from the middle of the disk: `2 ∫ dA`, `6 ∫ y dA`, `24 ∫ (a², a b, b²) dA`.
    area: f64,
    first: Vector2<f64>,
    second: Vector3<f64>,
    /// Of the arcs: their angles, the differences of their ends, and those of (−2 a b, a² − b²): half its derivative by the angle is
    /// (b² − a², −2 a b).
    angle: f64,
    chord: Vector2<f64>,
    twist: Vector2<f64>,
}

/// A point of the plane of a disk, and the same from the middle of the disk in its axes.
type Placed = (Vector3<f64>, Vector2<f64>);

impl<'a> Disk<'a> {
    fn new(plane: &Plane, arcs: &'a mut Vec<Arc>) -> Self {
        // Of Duff and others (2017).
        let u = plane.normal;
        let sign = 1.0_f64.copysign(u.z);
        let a = -1.0 / (sign + u.z);
        let b = u.x * u.y * a;
        Self {
            plane: *plane,
            axes: [
                Vector3::new(1.0 + sign * u.x * u.x * a, sign * b, -sign * u.x),
                Vector3::new(b, sign + u.y * u.y * a, -u.y),
            ],
            arcs,
            area: 0.0,
            first: Vector2::zeros(),
            second: Vector3::zeros(),
            angle: 0.0,
            chord: Vector2::zeros(),
            twist: Vector2::zeros(),
        }
    }

    fn place(&self, point: Vector3<f64>) -> Placed {
        let [s, t] = &self.axes;
        (point, Vector2::new(s.dot(&point), t.dot(&point)))
    }

    /// The polygon with these corners: triangles where its edges are in the disk, arcs where they are outside.
    fn go_round(&mut self, points: &[Vector3<f64>], is_inside: &[bool], corners: &[usize]) {
        // The way outside: from where it left the disk, and how far it has turned since; at first, before it came in.
        let mut left = None;
        let mut turn = 0.0;
        let mut came_first = None;
        let mut a = corners[corners.len() - 1];
        let (_, mut p) = self.place(points[a]);
        for &b in corners {
            let (_, q) = self.place(points[b]);
            if is_inside[a] && is_inside[b] {
                self.add_triangle(&p, &q);
            } else if let Some((enter, leave)) = crossings(points, is_inside, a, b) {
                let mut from = p;
                if let Some(enter) = enter {
                    let enter = self.place(enter);
                    turn += quarters(&p, &enter.1);
                    match left.take() {
                        Some(from) => self.push_arc(from, enter, turn),
                        None => came_first = Some((enter, turn)),
                    }
                    turn = 0.0;
                    from = enter.1;
                }
                if let Some(leave) = leave {
                    let leave = self.place(leave);
                    self.add_triangle(&from, &leave.1);
                    left = Some(leave);
                    turn = quarters(&leave.1, &q);
                } else {
                    self.add_triangle(&from, &q);
                }
            } else {
                turn += quarters(&p, &q);
            }
            (a, p) = (b, q);
        }
        match (left, came_first) {
            (Some(from), Some((to, before))) => self.push_arc(from, to, turn + before),
            // All edges are outside the disk, and it is within the polygon or not.
            (None, None) if turn > 2.0 => {
                self.angle += TAU;
                self.arcs.push(Arc {
                    plane: self.plane,
                    from: self.plane.normal,
                    to: self.plane.normal,
                    angle: TAU,
                    is_circle: true,
                });
            }
            _ => {}
        }
    }

    /// Adds the arc between two points, on the way between which the polygon turned by about so many quarters.
    fn push_arc(&mut self, (from, p): Placed, (to, q): Placed, turn: f64) {
        let angle = p.perp(&q).atan2(p.dot(&q));
        let rounds = ((turn * FRAC_PI_2 - angle) / TAU).round();
        let angle = angle + rounds * TAU;
        let twist = |r: &Vector2<f64>| Vector2::new(-2.0 * r.x * r.y, (r.x - r.y) * (r.x + r.y));
        self.angle += angle;
        self.chord += q - p;
        self.twist += twist(&q) - twist(&p);
        self.arcs.push(Arc {
            plane: self.plane,
            from,
            to,
            angle,
            is_circle: false,
        });
    }

    fn add_triangle(&mut self, p: &Vector2<f64>, q: &Vector2<f64>) {
        let (area, sum) = (p.perp(q), p + q);
        let of = |r: &Vector2<f64>| Vector3::new(r.x * r.x, r.x * r.y, r.y * r.y);
        self.area += area;
        self.first += sum * area;
        self.second += (of(p) + of(q) + of(&sum)) * area;
    }

    /// Adds the sectors under the arcs, the cone from the center of the ball over the face, and what its arcs say of the patch.
    fn finish(self, sum: &mut Boundary) {
        let (u, h) = (self.plane.normal, self.plane.height);
        let square = (1.0 - h) * (1.0 + h);
        let around = square * self.angle;
        let chord = Vector2::new(self.chord.y, -self.chord.x);
        let twist = Vector3::new(self.twist.x, self.twist.y, -self.twist.x);
        let one = Vector3::new(1.0, 0.0, 1.0);
        let area = 0.5 * (self.area + around);
        let first = self.first / 6.0 + chord * (square / 3.0);
        let second = self.second / 24.0 + one * (square * around / 8.0) - twist * (square / 16.0);
        // In the axes s, t, u: of the face, and with the arcs counter-clockwise about the face, the patch on their right.
        let outward = first * h + chord * (0.5 * h);
        let across = first * (h * h) - chord * ((1.0 - 2.0 * h * h) / 6.0);
        let along = second * h + (one * (0.5 * around) - twist * 0.25) * (h / 3.0);
        let up = h * (h * h * area - around / 3.0);
        let axes = Matrix3::from_columns(&[self.axes[0], self.axes[1], u]);
        sum.faces += 1;
        sum.volume += h * area;
        sum.first += axes * Vector3::new(outward.x, outward.y, h * h * area - 0.5 * around);
        #[rustfmt::skip]
        let second = Matrix3::new(
            along.x, along.y, across.x,
            along.y, along.z, across.y,
            across.x, across.y, up,
        );
        sum.second += axes * second * axes.transpose();
    }
}

/// The angle from one point to another, seen from the middle of the disk, in quarters of a turn and off by at most a
/// tenth of a quarter: enough to count rounds.
fn quarters(p: &Vector2<f64>, q: &Vector2<f64>) -> f64 {
    let (y, x) = (p.perp(q), p.dot(q));
    let sum = x.abs() + y.abs();
    if sum == 0.0 {
        return 0.0;
    }
    (1.0 - x / sum).copysign(y)
}

/// Where an edge enters a ball and leaves it.
type Ends = (Option<Vector3<f64>>, Option<Vector3<f64>>);

/// Where the edge from corner a to corner b, not both inside, is in the unit ball: where it enters and leaves, `None` where it does at its ends.
/// `None` of an edge outside.
///
/// Both faces of an edge ask: so what decides is computed in one order of its ends.
fn crossings(points: &[Vector3<f64>], is_inside: &[bool], a: usize, b: usize) -> Option<Ends> {
    let (low, high) = (a.min(b), a.max(b));
    let (p, edge) = (points[low], points[high] - points[low]);
    let length = edge.norm_squared();
    if length == 0.0 {
        return None;
    }
    let middle = -p.dot(&edge) / length;
    let square = 1.0 - (p + edge * middle).norm_squared();
    if square <= 0.0 && !(is_inside[a] || is_inside[b]) {
        return None;
    }
    let half = (square.max(0.0) / length).sqrt();
    let from = if is_inside[low] {
        0.0
    } else {
        (middle - half).clamp(0.0, 1.0)
    };
    let to = if is_inside[high] {
        1.0
    } else {
        (middle + half).clamp(0.0, 1.0)
    };
    if from >= to && !(is_inside[a] || is_inside[b]) {
        return None;
    }
    let at = |part: f64, is_end: bool| (!is_end).then(|| p + edge * part);
    let (first, last) = (at(from, is_inside[low]), at(to, is_inside[high]));
    Some(if a == low {
        (first, last)
    } else {
        (last, first)
    })
}

/// The area that the arcs enclose on their left, up to whole spheres; `points` is memory for their pieces.
fn removed_area(arcs: &[Arc], points: &mut Vec<Vector3<f64>>) -> f64 {
    points.clear();
    for arc in arcs.iter().filter(|arc| !arc.is_circle) {
        arc.push_points(points);
    }
    let pole = pole(points);
    let mut sum = 0.0;
    let mut first = 0;
    for arc in arcs {
        // About the normal that points to the nearer cap.
        let near = arc.plane.height.abs();
        let angle = arc.angle.copysign(arc.angle * arc.plane.height);
        let (less, more) = (1.0 - near, 1.0 + near);
        if arc.is_circle {
            sum += angle * less;
            continue;
        }
        let pieces = arc.pieces();
        let step = angle / pieces as f64;
        let (sine, cosine) = step.sin_cos();
        let segment = step * less - 2.0 * (less * sine).atan2(more + less * cosine);
        sum += segment * pieces as f64;
        for k in first..first + pieces {
            let (from, to) = (points[k], points[k + 1]);
            let volume = pole.dot(&from.cross(&to));
            let around = 1.0 + pole.dot(&from) + from.dot(&to) + to.dot(&pole);
            sum += 2.0 * volume.atan2(around);
        }
        first += pieces + 1;
    }
    sum
}

impl Arc {
    /// In how many pieces its area is taken, each of a quarter of a circle at most.
    fn pieces(&self) -> usize {
        let quarters = self.angle.abs() / FRAC_PI_2;
        1 + usize::from(quarters > 1.0) + usize::from(quarters > 2.0) + usize::from(quarters > 3.0)
    }

    /// Adds its ends and the points that cut it into pieces.
    fn push_points(&self, points: &mut Vec<Vector3<f64>>) {
        let middle = self.plane.normal * self.plane.height;
        let (s, t) = (self.from - middle, self.plane.normal.cross(&self.from));
        let pieces = self.pieces();
        points.push(self.from);
        for k in 1..pieces {
            let (sine, cosine) = (self.angle * (k as f64 / pieces as f64)).sin_cos();
            points.push(middle + s * cosine + t * sine);
        }
        points.push(self.to);
    }
}

/// A point of the sphere whose opposite is far from these points: a triangle that reaches to the opposite of a corner is known
/// badly.
fn pole(points: &[Vector3<f64>]) -> Vector3<f64> {
    /// Farther than this, no digit that counts is lost.
    const FAR: f64 = 0.2;
    let directions = (0..27).filter(|&k| k != 13).map(|k| {
        let digit = |of: i32| f64::from(of % 3 - 1);
        // Askew, since points lie along axes and diagonals more often than elsewhere.
        Vector3::new(digit(k) + 0.21, digit(k / 3) - 0.13, digit(k / 9) + 0.07).normalize()
    });
    let mut best = (f64::NEG_INFINITY, Vector3::z());
    for pole in directions {
        let mut nearest = f64::INFINITY;
        for point in points {
            nearest = nearest.min(1.0 + pole.dot(point));
            if nearest <= best.0 {
                break;
            }
        }
        if nearest > best.0 {
            best = (nearest, pole);
        }
        if nearest > FAR {
            break;
        }
    }
    best.1
}
