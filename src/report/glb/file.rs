//! Binary glTF 2.0 file: buffer, accessors, nodes.

use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target as Moved};
use gltf_json::buffer::{Target, View};
use gltf_json::material::{AlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::{Checked::Valid, USize64};
use gltf_json::{Animation, Asset, Buffer, Index, Material, Mesh, Node, Root, Scene, serialize};
use nalgebra::Vector3;
use serde_json::json;

/// File under construction: the JSON part and the buffer.
pub struct GlbFile {
    root: Root,
    numbers: Vec<u8>,
}

/// Geometry of a mesh: triangles with normals, or lines.
pub struct GlbSurface<'s> {
    pub positions: &'s [Vector3<f64>],
    /// Normals of triangles; empty for lines.
    pub normals: &'s [Vector3<f64>],
    /// Colour of each vertex (linear red, green, blue); empty if the material states one colour.
    pub colours: &'s [[f64; 3]],
    pub indices: Vec<u32>,
}

/// Returns vectors as numbers in single precision, which the format uses.
fn single<'v>(vectors: impl IntoIterator<Item = &'v Vector3<f64>>) -> Vec<f32> {
    vectors.into_iter().flat_map(|v| [v.x as f32, v.y as f32, v.z as f32]).collect()
}

impl GlbFile {
    pub fn new() -> Self {
        let generator = Some(format!("sweetspot {}", env!("CARGO_PKG_VERSION")));
        let asset = Asset { generator, ..Asset::default() };
        Self { root: Root { asset, ..Root::default() }, numbers: Vec::new() }
    }

    fn view(&mut self, bytes: &[u8], target: Option<Target>) -> Index<View> {
        let view = View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.numbers.len())),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Default::default(),
        };
        self.numbers.extend(bytes);
        Index::push(&mut self.root.buffer_views, view)
    }

    /// Adds an accessor of elements of the type `kind`, such as vectors. If `bounds` is true, the accessor
    /// states the least and the greatest value of each component.
    fn floats(&mut self, kind: Type, values: &[f32], of: Option<Target>, bounds: bool) -> Index<Accessor> {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let width = kind.multiplicity();
        let bound = |fold: fn(f32, f32) -> f32| {
            let of = |k: usize| values.iter().copied().skip(k).step_by(width).reduce(fold);
            bounds.then(|| json!((0..width).filter_map(of).collect::<Vec<_>>()))
        };
        let (min, max) = (bound(f32::min), bound(f32::max));
        let view = self.view(&bytes, of);
        self.accessor(view, values.len() / width, (ComponentType::F32, kind), (min, max))
    }

    fn accessor(
        &mut self,
        view: Index<View>,
        count: usize,
        (component, kind): (ComponentType, Type),
        (min, max): (Option<serde_json::Value>, Option<serde_json::Value>),
    ) -> Index<Accessor> {
        let accessor = Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Valid(GenericComponentType(component)),
            extensions: None,
            extras: Default::default(),
            type_: Valid(kind),
            min,
            max,
            name: None,
            normalized: false,
            sparse: None,
        };
        Index::push(&mut self.root.accessors, accessor)
    }

    /// Adds a mesh, unless it is empty.
    pub fn mesh(
        &mut self,
        name: &str,
        surface: &GlbSurface<'_>,
        material: Index<Material>,
    ) -> Option<Index<Mesh>> {
        if surface.indices.is_empty() {
            return None;
        }
        let of = Some(Target::ArrayBuffer);
        let positions = self.floats(Type::Vec3, &single(surface.positions), of, true);
        let mut attributes = vec![(Semantic::Positions, positions)];
        if !surface.normals.is_empty() {
            let normals = self.floats(Type::Vec3, &single(surface.normals), of, false);
            attributes.push((Semantic::Normals, normals));
        }
        if !surface.colours.is_empty() {
            let colours: Vec<f32> = surface.colours.iter().flatten().map(|c| *c as f32).collect();
            attributes.push((Semantic::Colors(0), self.floats(Type::Vec3, &colours, of, false)));
        }
        let bytes: Vec<u8> = surface.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(Target::ElementArrayBuffer));
        let indices =
            self.accessor(view, surface.indices.len(), (ComponentType::U32, Type::Scalar), (None, None));
        let mode = if surface.normals.is_empty() { Mode::Lines } else { Mode::Triangles };
        let primitive = Primitive {
            attributes: attributes.into_iter().map(|(what, index)| (Valid(what), index)).collect(),
            extensions: None,
            extras: Default::default(),
            indices: Some(indices),
            material: Some(material),
            mode: Valid(mode),
            targets: None,
        };
        let mesh = Mesh {
            extensions: None,
            extras: Default::default(),
            name: Some(name.to_string()),
            primitives: vec![primitive],
            weights: None,
        };
        Some(Index::push(&mut self.root.meshes, mesh))
    }

    /// Adds a material with a colour (linear red, green, blue and opacity) and a roughness.
    pub fn material(&mut self, name: &str, colour: [f64; 4], roughness: f32) -> Index<Material> {
        let material = Material {
            name: Some(name.to_string()),
            alpha_mode: Valid(if colour[3] < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque }),
            double_sided: true,
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor(colour.map(|c| c as f32)),
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(roughness),
                ..Default::default()
            },
            ..Default::default()
        };
        Index::push(&mut self.root.materials, material)
    }

    pub fn node(&mut self, node: Node) -> Index<Node> {
        Index::push(&mut self.root.nodes, node)
    }

    /// Adds a node that groups its children; returns None if there are no children.
    pub fn group(&mut self, name: &str, children: Vec<Index<Node>>) -> Option<Index<Node>> {
        let node = Node { name: Some(name.to_string()), children: Some(children), ..Node::default() };
        (!node.children.as_ref()?.is_empty()).then(|| self.node(node))
    }

    /// Adds the times of an animation, s.
    pub fn times(&mut self, times: &[f64]) -> Index<Accessor> {
        let times: Vec<f32> = times.iter().map(|t| *t as f32).collect();
        self.floats(Type::Scalar, &times, None, true)
    }

    /// Adds the motion of a node. A rotation has four numbers per time; a translation or a scale has three.
    pub fn channel(
        &mut self,
        to: &mut Animation,
        (node, property): (Index<Node>, Property),
        input: Index<Accessor>,
        values: &[f32],
    ) {
        let kind = if property == Property::Rotation { Type::Vec4 } else { Type::Vec3 };
        let way = if property == Property::Scale { Interpolation::Step } else { Interpolation::Linear };
        let output = self.floats(kind, values, None, false);
        let sampler = Sampler {
            extensions: None,
            extras: Default::default(),
            input,
            interpolation: Valid(way),
            output,
        };
        let sampler = Index::push(&mut to.samplers, sampler);
        let target = Moved { extensions: None, extras: Default::default(), node, path: Valid(property) };
        to.channels.push(Channel { sampler, target, extensions: None, extras: Default::default() });
    }

    /// Returns an animation without channels.
    pub fn animation(name: &str) -> Animation {
        Animation {
            extensions: None,
            extras: Default::default(),
            channels: Vec::new(),
            name: Some(name.to_string()),
            samplers: Vec::new(),
        }
    }

    /// Returns the bytes of the file: header, JSON and buffer. The length of each is a multiple of 4 bytes.
    ///
    /// # Errors
    /// Fails if the JSON writer fails, or if the file exceeds 4 GB.
    pub fn bytes(mut self, top: Index<Node>, animation: Option<Animation>) -> Result<Vec<u8>, String> {
        let scene = Scene { extensions: None, extras: Default::default(), name: None, nodes: vec![top] };
        self.root.scene = Some(Index::push(&mut self.root.scenes, scene));
        self.root.animations.extend(animation.filter(|a| !a.channels.is_empty()));
        self.root.buffers.push(Buffer {
            byte_length: USize64::from(self.numbers.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        let mut json = serialize::to_vec(&self.root).map_err(|e| e.to_string())?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let word = |n: usize| u32::try_from(n).map(u32::to_le_bytes).map_err(|_| "exceeds 4 GB".to_string());
        let mut bytes = Vec::from(*b"glTF\x02\0\0\0");
        bytes.extend(word(12 + 8 + json.len() + 8 + self.numbers.len())?);
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.numbers)] {
            bytes.extend(word(chunk.len())?);
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        Ok(bytes)
    }
}

/// Returns the rotation of a node from a quaternion in the order of glTF: x, y, z, w.
pub fn quaternion(q: [f32; 4]) -> Option<UnitQuaternion> {
    Some(UnitQuaternion(q))
}
